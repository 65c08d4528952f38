//! The paper's tables and figures again, ours beside the published values:
//! `cargo run --release --example paper -- all --out docs/paper`.

fn main() -> std::process::ExitCode {
    auv_paper::main()
}
