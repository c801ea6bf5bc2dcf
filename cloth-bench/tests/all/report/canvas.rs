//! Text of a plot, in lines.

use cloth_bench::report::canvas::{text_width, wrap};

#[test]
fn wrapped_lines_fit_and_lose_nothing() {
    let text =
        "a few words and averyverylongwordwithoutanyblankinsideitatallreally and an end then";
    let lines = wrap(text, 13, 120);
    assert!(
        lines.iter().all(|line| text_width(line, 13) <= 130),
        "{lines:?}"
    );
    assert_eq!(lines.concat().replace(' ', ""), text.replace(' ', ""));
    let short = text.replace(
        "averyverylongwordwithoutanyblankinsideitatallreally",
        "more",
    );
    for width in 60..400 {
        assert_eq!(wrap(&short, 13, width).join(" "), short, "words stay whole");
    }
    assert!(wrap("", 13, 100).is_empty());
    assert_eq!(wrap("one line", 13, 500), ["one line"]);
}
