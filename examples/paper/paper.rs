//! The paper's tables and figures, with our values beside the published ones:
//! `cargo run --release --example paper -- all --out docs/paper`.

fn main() -> std::process::ExitCode {
    auv_paper::main()
}
