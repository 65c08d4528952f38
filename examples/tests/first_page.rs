//! The first page's programs are those of the facade crate's README, whose doctests run them.

fn rust_blocks(text: &str) -> Vec<&str> {
    text.split("```rust\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .collect()
}

#[test]
fn the_programs_of_the_first_page_are_compiled() {
    let first_page = rust_blocks(include_str!("../../README.md"));
    let compiled = rust_blocks(include_str!("../../crates/auv/README.md"));
    assert_eq!(first_page.len(), 3, "a route, a path, a mission");
    assert_eq!(first_page, compiled);
}
