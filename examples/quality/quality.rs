//! How good the planners' answers are, against the best known:
//! `cargo run --release --example quality -- paths` (or `sea`, `routes`, `threads`, `waypoints`).

fn main() -> std::process::ExitCode {
    auv_quality::main()
}
