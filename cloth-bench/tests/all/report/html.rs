//! The page of a report.

use cloth_bench::report::html::{Answer, Picture, Report, Section, base64};
use cloth_bench::report::plot::{Plot, Series};
use cloth_bench::report::table::Table;

/// Checks what a browser would not complain about: every element closed, every `<` an element.
pub(crate) fn assert_well_formed(markup: &str) {
    let mut open = Vec::new();
    let markup = markup.strip_prefix("<!DOCTYPE html>").unwrap_or(markup);
    for piece in markup.split('<').skip(1) {
        let (tag, text) = piece.split_once('>').expect("every tag ends");
        assert_eq!(
            tag.matches('"').count() % 2,
            0,
            "quotes are balanced: {tag}"
        );
        assert!(
            !text.contains('>') || open.last() == Some(&"style"),
            "stray > in {text}"
        );
        for entity in text.split('&').skip(1).chain(tag.split('&').skip(1)) {
            assert!(
                entity.find(';').is_some_and(|end| end <= 5),
                "bare & before {entity:.20}"
            );
        }
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "closes the element that is open");
        } else if !tag.ends_with('/') {
            open.push(tag.split_whitespace().next().expect("a tag has a name"));
        }
    }
    assert!(open.is_empty(), "left open: {open:?}");
}

#[test]
fn base64_agrees_with_rfc_4648() {
    for (bytes, text) in [
        ("", ""),
        ("f", "Zg=="),
        ("fo", "Zm8="),
        ("foo", "Zm9v"),
        ("foob", "Zm9vYg=="),
        ("fooba", "Zm9vYmE="),
        ("foobar", "Zm9vYmFy"),
    ] {
        assert_eq!(base64(bytes.as_bytes()), text);
    }
    assert_eq!(base64(&[0xfb, 0xff, 0xfe]), "+//+");
}

fn nasty() -> Report {
    let nasty = "<script>alert(\"x\")</script> & 'more' \u{1}";
    let mut table = Table::new(&[nasty]);
    table.line(nasty, []);
    let answer = |kind: &str| Answer {
        question: nasty.into(),
        answer: nasty.into(),
        table: Some(table.clone()),
        figure: format!("{kind}-{nasty}"),
        section: nasty.into(),
    };
    let answers = ["figure", "table"].map(answer).into();
    let plot = Plot {
        title: nasty.into(),
        series: vec![Series::new(nasty, vec![(0.0, 1.0)])],
        note: nasty.into(),
        ..Plot::default()
    };
    let section = Section {
        id: nasty.into(),
        title: nasty.into(),
        question: nasty.into(),
        leads: false,
        verdict: Some(nasty.into()),
        rests_on: String::new(),
        detail: nasty.into(),
        command: nasty.into(),
        plots: vec![(nasty.into(), plot.draw().svg)],
        pictures: vec![Picture {
            png: vec![1, 2, 3],
            caption: nasty.into(),
        }],
        playbacks: Vec::new(),
        tables: vec![(nasty.into(), nasty.into(), table)],
        notes: vec![nasty.into()],
    };
    Report {
        title: nasty.into(),
        facts: vec![(nasty.into(), nasty.into())],
        answers,
        sections: vec![section.clone(), section],
    }
}

#[test]
fn everything_is_escaped() {
    let html = nasty().to_html();
    assert_well_formed(&html);
    assert!(!html.contains("<script") && !html.contains('\u{1}'));
}

#[test]
fn the_page_needs_nothing_from_outside() {
    let html = nasty().to_html();
    let addresses =
        html.matches("http").count() - html.matches("http://www.w3.org/2000/svg").count();
    assert_eq!(addresses, 0);
    assert!(!html.contains("<link") && !html.contains("@import") && !html.contains("url("));
}

/// Of a section's answer a sentence and the way to its figure are to be seen, the numbers behind it on demand.
#[test]
fn an_answer_leads_to_its_figure_and_its_numbers_are_folded_away() {
    let mut report = nasty();
    report.sections[0].plots[0].0 = "sag".into();
    report.sections[0].verdict = Some("It sags.".into());
    report.sections[0].detail = "By 1 mm.".into();
    let html = report.to_html();
    let answer = "<p class=\"verdict\">It sags. <a href=\"#figure-sag\">figure</a></p>";
    let numbers = "<details><summary>In numbers</summary><p>By 1 mm.</p></details>";
    assert!(html.contains(&format!("{answer}\n{numbers}")));
}

#[test]
fn the_section_that_leads_comes_before_the_answers() {
    let mut report = nasty();
    report.sections[0].leads = true;
    let html = report.to_html();
    assert_well_formed(&html);
    let at = |what: &str| html.find(what).unwrap();
    assert!(at("class=\"lead\"") < at("class=\"answers\""));
    // Its table opens it.
    assert!(at("id=\"table-") < at("<svg"));
    assert_eq!(html.matches("<section").count(), 2);
}

/// Contents lead to sections, and answers to their plots and tables, of sections too.
#[test]
fn every_link_leads_somewhere() {
    let html = nasty().to_html();
    let targets = html.split("href=\"#").skip(1);
    let targets: Vec<&str> = targets.filter_map(|rest| rest.split('"').next()).collect();
    let figure = "<figure class=\"plot\"";
    let places = [figure, "<div", "<section", "<section", figure, figure];
    assert_eq!(targets.len(), places.len());
    for (target, place) in targets.iter().zip(places) {
        assert!(
            html.contains(&format!("{place} id=\"{target}\">")),
            "{target}"
        );
    }
}

#[test]
fn an_empty_report_is_a_page() {
    assert_well_formed(&Report::default().to_html());
    let empty = Report {
        sections: vec![Section::default()],
        ..Report::default()
    };
    assert_well_formed(&empty.to_html());
}
