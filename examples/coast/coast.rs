//! Random coastal missions, written as mission files or flown and judged:
//! `cargo run --release --example coast -- --missions 100`.

fn main() -> std::process::ExitCode {
    auv_coast::main()
}
