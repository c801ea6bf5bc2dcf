//! Tables as text, CSV and HTML.

use cloth_bench::report::table::{Cell, Mark, Table, percent, significant};

/// Reads RFC 4180 back: fields, and whether each was quoted.
fn parse(csv: &str) -> Vec<Vec<(String, bool)>> {
    let (mut rows, mut row, mut field) = (Vec::new(), Vec::new(), String::new());
    let (mut inside, mut was_quoted) = (false, false);
    let mut letters = csv.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if inside && letters.peek() == Some(&'"') => field.extend(letters.next()),
            '"' => (inside, was_quoted) = (!inside, true),
            ',' if !inside => {
                row.push((std::mem::take(&mut field), std::mem::take(&mut was_quoted)))
            }
            '\r' if !inside => {
                assert_eq!(letters.next(), Some('\n'));
                row.push((std::mem::take(&mut field), std::mem::take(&mut was_quoted)));
                rows.push(std::mem::take(&mut row));
            }
            _ => field.push(letter),
        }
    }
    assert!(field.is_empty() && row.is_empty(), "the last line ends");
    rows
}

#[test]
fn marks_are_for_people() {
    let mut table = Table::new(&["ms"]);
    table.line(Cell::Marked("1 < 2".into(), Mark::Best), []);
    assert_eq!(table.to_csv(), "ms\r\n1 < 2\r\n");
    assert!(table.to_text().contains("★ 1 < 2"));
    assert!(
        table
            .to_html()
            .contains("<td class=\"number best\">★ 1 &lt; 2</td>")
    );
}

#[test]
fn csv_text_reads_back() {
    let texts = [
        "plain",
        "a,b",
        "say \"hi\"",
        "two\r\nlines",
        " blank",
        "",
        "\"",
        "ü → λ",
    ];
    let mut table = Table::new(&["name, quoted"]);
    for text in texts {
        table.line(text, []);
    }
    let rows = parse(&table.to_csv());
    assert_eq!(rows[0][0].0, "name, quoted");
    for (row, text) in rows[1..].iter().zip(texts) {
        assert_eq!(row[0].0, text);
    }
}

#[test]
fn csv_numbers_read_back_to_the_last_bit() {
    let numbers = [
        0.1,
        1.0 / 3.0,
        -0.0,
        5e-324,
        f64::MAX,
        1e23,
        f64::INFINITY,
        f64::NAN,
    ];
    let mut table = Table::new(&["x (m)"]);
    for number in numbers {
        table.line(number, []);
    }
    for (row, number) in parse(&table.to_csv())[1..].iter().zip(numbers) {
        let read: f64 = row[0].0.parse().unwrap();
        assert!(read.to_bits() == number.to_bits() || read.is_nan() && number.is_nan());
    }
}

#[test]
fn missing_is_not_the_empty_text() {
    let mut table = Table::new(&["a", "b"]);
    table.line(Cell::Missing, ["".into()]);
    assert_eq!(table.to_csv(), "a,b\r\n,\"\"\r\n");
}

#[test]
fn text_stands_in_columns() {
    let mut table = Table::new(&["name", "x (m)"]);
    table.line("λ", [0.125.into()]);
    table.line("longer", [Cell::Missing]);
    assert_eq!(
        table.to_text(),
        "name    x (m)\nλ       0.125\nlonger      –\n"
    );
}

#[test]
fn html_is_escaped_and_numbers_stand_right() {
    let mut table = Table::new(&["<name>", "n"]);
    table.line("a<b & c", [12_usize.into()]);
    let html = table.to_html();
    assert!(html.contains("&lt;name&gt;") && html.contains("a&lt;b &amp; c"));
    assert!(html.contains("<th scope=\"col\" class=\"number\">n</th>"));
    assert!(html.contains("<td class=\"number\">12</td>"));
}

#[test]
fn significant_digits() {
    for (number, text) in [
        (0.0, "0"),
        (1.0, "1"),
        (-0.5, "−0.5"),
        (1234.5678, "1235"),
        (99999.9, "1e5"),
        (0.99996, "1"),
        (0.001234567, "0.001235"),
        (1.5e-7, "1.5e-7"),
        (-2.0e8, "−2e8"),
        (12000.0, "12000"),
        (f64::NAN, "NaN"),
    ] {
        assert_eq!(significant(number, 4), text);
    }
}

#[test]
fn a_share_is_told_in_two_digits_and_beyond_all_measure_as_a_power() {
    let told = [0.0, 4e-5, 0.01234, 1.5, 4134.7, 5.7e19].map(percent);
    assert_eq!(told, ["0 %", "0 %", "1.2 %", "150 %", "413470 %", "6e21 %"]);
}
