//! What stands in the pages.

use crate::Folder;
use proptest::prelude::*;
use rollin::corpus::Corpus;
use rollin::read::conll;
use rollin::report::{Axis, Dot, Figure, Matrix, Page, Plot, Series, escaped, evenly};
use rollin::tasks::tagging;
use rollin::tasks::{AnyLearner, Learned, Task, Trainer};
use rollin::trainer::{Cpi, Rate, Run, Searn, Smile};
use roxmltree::{Document, Node, ParsingOptions};
use serde_json::Value;

/// The most that a page may weigh.
const MOST: usize = 500_000;

/// The document, which is XML, too.
fn parsed(text: &str) -> Document<'_> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn text_of(node: Node<'_, '_>) -> String {
    node.descendants().filter(Node::is_text).filter_map(|text| text.text()).collect()
}

/// The element with this id.
fn by_id<'a>(page: &'a Document<'_>, id: &str) -> Node<'a, 'a> {
    page.descendants().find(|node| node.attribute("id") == Some(id)).unwrap_or_else(|| panic!("no {id}"))
}

/// The cells of the table below `node`, without the headings.
fn rows(node: Node<'_, '_>) -> Vec<Vec<String>> {
    let table = node.descendants().find(|node| node.has_tag_name("table") || node.tag_name().name() == "table");
    let cells = |row: Node<'_, '_>| row.children().filter(Node::is_element).map(text_of).collect();
    let rows = table.expect("a table").children().filter(Node::is_element).map(cells);
    rows.skip(1).collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("{text} is no number"))
}

/// What the page says of how it came to be.
fn fact(page: &Document<'_>, name: &str) -> String {
    let terms = page.descendants().filter(|node| node.tag_name().name() == "dt");
    let mut found = terms.filter(|term| text_of(*term) == name);
    let term = found.next().unwrap_or_else(|| panic!("no {name}"));
    text_of(term.next_sibling_element().expect("a description"))
}

/// What every page must keep to.
fn sound(page: &str) {
    assert!(page.len() < MOST, "{} bytes", page.len());
    for needs in ["http://", "https://"] {
        let outside = page.matches(needs).count();
        // Names of languages, which nobody fetches.
        let names = page.matches("\"http://www.w3.org/").count();
        assert_eq!(outside, if needs == "http://" { names } else { 0 }, "the page needs nothing else");
    }
    assert!(!page.contains("NaN") && !page.contains("inf\""), "numbers that are none");
    let document = parsed(page);
    for svg in document.descendants().filter(|node| node.tag_name().name() == "svg") {
        let shapes = svg
            .descendants()
            .filter(|node| matches!(node.attribute("class"), Some("mark" | "cell right" | "cell wrong")));
        assert!(shapes.count() > 0, "nothing is drawn");
    }
    // Every figure has its numbers, hidden controls, and nothing that the script would have to draw first.
    for figure in document.descendants().filter(|node| node.tag_name().name() == "figure") {
        assert!(!rows(figure).is_empty() || figure.attribute("id") == Some("confusion"));
        let controls = figure.descendants().find(|node| node.attribute("class") == Some("controls"));
        assert!(controls.is_none_or(|controls| controls.attribute("hidden").is_some()));
    }
}

#[test]
fn pages_hold_what_json_holds() {
    let folder = Folder::new();
    let all = folder.pages();
    for name in all.keys() {
        sound(&folder.text(&format!("{name}.html")));
        let mut drawn = 0;
        for entry in std::fs::read_dir(folder.path(&format!("{name}-svg"))).expect("a folder") {
            let text = std::fs::read_to_string(entry.expect("an entry").path()).expect("text");
            assert_eq!(parsed(&text).root_element().tag_name().name(), "svg");
            drawn += 1;
        }
        let figures = folder.text(&format!("{name}.html")).matches("<figure").count();
        assert!(drawn == figures && drawn > 0, "{name}: {drawn} of {figures}");
    }
    compared(&folder.text("compare.html"), &all["compare"]);
    evaluated(&folder.text("evaluate.html"), &all["evaluate"]);
    audited(&folder.text("audit.html"), &all["audit"]);
    closed(&folder.text("bounds.html"), &all["bounds"]);
}

fn compared(text: &str, json: &Value) {
    let page = parsed(text);
    let algorithms = json["rows"].as_array().expect("rows");
    let mut loss = rows(by_id(&page, "loss")).into_iter();
    let mut ledger = rows(by_id(&page, "ledger")).into_iter();
    for row in algorithms {
        let name = row["algorithm"].as_str().expect("a name");
        for reading in row["readings"].as_array().expect("readings") {
            let cells = loss.next().expect("a row");
            assert_eq!((cells[0].as_str(), cells[1].as_str()), (name, reading["reading"].as_str().unwrap_or("")));
            assert_eq!(Some(number(&cells[2])), row["ledger"]["queries"].as_f64());
            assert_eq!(Some(number(&cells[3])), reading["loss"].as_f64());
        }
        for key in ["labels", "expert_acts", "rollout_acts", "queries", "rollouts", "resets", "steps", "examples"] {
            let cells = ledger.next().expect("a row");
            assert_eq!(Some(number(&cells[2])), row["expected"][key].as_f64(), "{name} {cells:?}");
            assert_eq!(Some(number(&cells[3])), row["ledger"][key].as_f64(), "{name} {cells:?}");
        }
        let Some(weights) = row["weights"].as_array() else { continue };
        let mixture = rows(by_id(&page, &format!("weights-{name}")));
        for cells in mixture {
            let member = cells[0].strip_prefix("classifier ").map_or(0, |n| number(n) as usize);
            assert_eq!(
                Some(number(&cells[2])),
                weights[number(&cells[1]) as usize][member].as_f64(),
                "{name} {cells:?}"
            );
        }
    }
    assert_eq!((loss.next(), ledger.next()), (None, None));
    assert_eq!(fact(&page, "seed"), "3");
    let command = "rollin compare --data 'a<b>&'\\''.txt' --test test.txt --algorithms supervised,smile,searn,dagger --seed 3 -q \
                   --html compare.html --svg compare-svg --json";
    assert_eq!(fact(&page, "command"), command);
    assert_eq!(fact(&page, "version"), concat!("rollin ", env!("CARGO_PKG_VERSION")));
    // By sha256sum.
    assert_eq!(fact(&page, "data"), format!("a<b>&'.txt: SHA-256 {}, {} bytes", TRAIN_SUM, crate::TRAIN.len()));
    assert_eq!(fact(&page, "test"), format!("test.txt: SHA-256 {}, {} bytes", TEST_SUM, crate::TEST.len()));
}

const TRAIN_SUM: &str = "1c7560c37a0324895dbd4bed01b0f753f6f8ab65048421508fb28fcdf188d3fb";
const TEST_SUM: &str = "36514a800c879f10c29717bcbec4860897b5e485d132b3b2bb960521d011bc9b";

fn evaluated(text: &str, json: &Value) {
    let page = parsed(text);
    let figure = by_id(&page, "confusion");
    let confusion = json["confusion"].as_object().expect("counts");
    let mut mistakes = 0;
    let mut cells = 0;
    for (right, row) in confusion {
        let row = row.as_object().expect("counts");
        let of: u64 = row.values().filter_map(Value::as_u64).sum();
        for (given, count) in row {
            let told = format!("{right} given {given}: {count} of {of} ");
            assert!(
                figure.descendants().any(|node| node.tag_name().name() == "title" && text_of(node).starts_with(&told)),
                "{told}"
            );
            cells += 1;
            if right != given {
                mistakes += 1;
                let row = [right.clone(), given.clone(), count.to_string(), of.to_string()];
                assert!(rows(figure).contains(&row.to_vec()), "{row:?}");
            }
        }
    }
    assert_eq!(
        figure.descendants().filter(|node| node.attribute("class").is_some_and(|c| c.starts_with("cell "))).count(),
        cells
    );
    assert_eq!(rows(figure).len(), mistakes);
    assert!(mistakes > 0 && confusion.contains_key("<b>"), "the test is about mistakes and odd labels");
    let total: u64 =
        confusion.values().filter_map(Value::as_object).flat_map(|row| row.values()).filter_map(Value::as_u64).sum();
    assert_eq!(Some(total), json["tokens"].as_u64());
}

fn audited(text: &str, json: &Value) {
    let page = parsed(text);
    let theorems = json["theorems"].as_array().expect("bounds");
    let drawn = rows(by_id(&page, "bounds"));
    assert_eq!(drawn.len(), theorems.len());
    for (cells, bound) in drawn.iter().zip(theorems) {
        assert_eq!(Some(cells[0].as_str()), bound["name"].as_str());
        let numbers = &cells[cells.len() - 2..];
        assert_eq!(
            [Some(number(&numbers[0])), Some(number(&numbers[1]))],
            [bound["lhs"].as_f64(), bound["rhs"].as_f64()]
        );
    }
    for cells in rows(by_id(&page, "weights-searn")) {
        let member = cells[0].strip_prefix("classifier ").map_or(0, |n| number(n) as usize);
        let weight = &json["searn"]["weights"][number(&cells[1]) as usize][member];
        assert_eq!(Some(number(&cells[2])), weight.as_f64(), "{cells:?}");
    }
    let smile = rows(by_id(&page, "weights-smile"));
    let last = json["smile"]["p"].as_array().expect("shares").len() - 1;
    for (member, weight) in json["smile"]["weights"].as_array().expect("weights").iter().enumerate() {
        let name = if member == 0 { "expert".to_owned() } else { format!("classifier {member}") };
        let row = [name, last.to_string(), weight.as_f64().expect("a number").to_string()];
        assert!(smile.contains(&row.to_vec()), "{row:?} in {smile:?}");
    }
    let costs: Vec<f64> = rows(by_id(&page, "rounds"))
        .iter()
        .filter(|row| row[0].contains("J(pi^n)"))
        .map(|row| number(&row[2]))
        .collect();
    let wanted: Vec<f64> = json["smile"]["J_pi"].as_array().expect("costs").iter().filter_map(Value::as_f64).collect();
    assert_eq!(costs, wanted);
}

fn closed(text: &str, json: &Value) {
    let page = parsed(text);
    let end = |figure: &str, series: &str| {
        let rows = rows(by_id(&page, figure));
        let row = rows.iter().rfind(|row| row[0].starts_with(series)).unwrap_or_else(|| panic!("no {series}")).clone();
        assert_eq!(Some(number(&row[1])), json["rounds"].as_f64());
        number(&row[2])
    };
    assert_eq!(Some(end("share", "p_n")), json["kept"].as_f64());
    assert_eq!(Some(end("dropping", "printed")), json["lemma_4_2"].as_f64());
    assert_eq!(Some(end("dropping", "by the steps left")), json["lemma_4_2_half"].as_f64());
    for (series, key) in
        [("no reuse", "samples_without_reuse"), ("Algorithm 4.2", "samples_42"), ("Algorithm 4.3", "samples_43")]
    {
        let (drawn, wanted) = (end("samples", series), json[key].as_f64().expect("a number"));
        assert!((drawn / wanted - 1.0).abs() < 1e-12, "{series}: {drawn} {wanted}");
    }
}

/// The embedded corpora have sums, too, and a page is written beside text.
#[test]
fn text_says_what_was_written() {
    let folder = Folder::new();
    let told = folder.run("compare --first 20 --algorithms supervised -q --html page.html");
    assert!(told.ends_with("wrote page.html\n"), "{told}");
    let text = folder.text("page.html");
    let page = parsed(&text);
    assert!(fact(&page, "data").starts_with("in the program: SHA-256 "));
    sound(&text);
}

#[test]
fn what_cannot_be_written_is_refused_first() {
    let folder = Folder::new();
    for (line, words) in [
        ("compare --data test.txt --html test.txt", "--html is test.txt"),
        ("compare --html nowhere/page.html", "nowhere/page.html"),
        ("compare --svg test.txt", "test.txt"),
        ("theory audit instance.json --html instance.json", "--html is instance.json"),
        ("theory audit none.json --html page.html", "none.json"),
        ("evaluate --model none.model --data test.txt --html page.html", "none.model"),
    ] {
        let output = folder.output(line);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && output.stdout.is_empty() && told.contains(words), "{line}: {told}");
    }
    assert_eq!(folder.text("test.txt"), crate::TEST);
    assert!(!folder.path("page.html").exists());
}

/// What is drawn as the mixture's weights is what training ends with.
#[test]
fn weights_are_those_that_are_trained() {
    let corpus: Corpus = conll::parse(b"a A\nb B\n\nb B\na A\n", "<test>".as_ref(), 1).expect("a corpus");
    let template = rollin::read::template::Template::default_for(1);
    let settings = tagging::Settings::from(template);
    let (_, problem) = <tagging::Encoding as Task>::learn(&corpus, settings).expect("it can be learned from");
    let learner = AnyLearner::Perceptron(rollin::learner::Perceptron::default());
    for trainer in [
        Trainer::Smile(Smile { alpha: 0.3, rounds: 4, ..Smile::default() }),
        Trainer::Searn(Searn { beta: 0.3, rounds: 4, ..Searn::default() }),
        Trainer::SearnShortcut(Searn { beta: 0.6, rounds: 2, ..Searn::default() }),
        Trainer::Cpi(Cpi { rate: Rate::Fixed(0.2), rounds: 3, ..Cpi::default() }),
    ] {
        let weights = trainer.weights().expect("it mixes").pop().expect("a round");
        let Learned::Mixture(mixture) = trainer.train(&problem, &learner, &Run::new(1)).expect("it trains").policy
        else {
            panic!("{trainer:?} mixes");
        };
        let rest: f64 = weights[1..].iter().sum();
        assert_eq!(mixture.members().len(), weights.len() - 1);
        for ((trained, _), weight) in mixture.members().iter().zip(&weights[1..]) {
            assert!((trained - weight / rest).abs() < 1e-12, "{trainer:?}");
        }
    }
    assert_eq!(Trainer::Cpi(Cpi { rate: Rate::Advantage, ..Cpi::default() }).weights(), None);
}

/// Many labels: the rest is one, and the figure stays small.
#[test]
fn many_labels_stay_a_figure() {
    let mut matrix = Matrix::default();
    for i in 0..300u32 {
        (0..=i / 7).for_each(|_| matrix.add(&format!("label {i}"), &format!("label {i}")));
        matrix.add(&format!("label {i}"), &format!("label {}", (i * 17 + 1) % 300));
    }
    let figure = Figure::matrix("confusion", "", "", &matrix);
    assert!(figure.file().contains("(others)") && figure.file().matches("<rect").count() <= 1600);
    let page = Page { figures: vec![figure], ..Page::default() }.html();
    sound(&page);
    let titles: u64 =
        (page.split("<title>").filter_map(|rest| rest.split_once(": ")?.1.split_once(" of ")?.0.parse::<u64>().ok()))
            .sum();
    assert_eq!(titles, matrix.cells().map(|(.., count)| count).sum::<u64>());
}

/// More numbers than a page can hold: each series keeps its ends.
#[test]
fn many_numbers_stay_a_page() {
    let line = |i: usize| {
        let dots = (0..5000).map(|n| Dot {
            x: n as f64,
            y: (n * i) as f64 / 7.0,
            interval: Some([0.0, 1.0]),
            name: format!("round {n}"),
        });
        Series::Line(format!("series {i}"), dots.collect())
    };
    let plot = Plot { series: (0..20).map(line).collect(), ..Plot::default() };
    let figure = Figure::plot("many", "Many", "", &plot);
    assert!(figure.note.contains("Not all is drawn"));
    let page = Page { figures: vec![figure.clone(), figure], ..Page::default() }.html();
    sound(&page);
    let page = parsed(&page);
    let rows = rows(by_id(&page, "many"));
    assert_eq!(rows.len(), 400);
    for series in rows.chunks(20) {
        assert_eq!((series[0][1].as_str(), series[19][1].as_str()), ("round 0", "round 4999"));
    }
    assert_eq!([evenly(3, 5), evenly(9, 3), evenly(5, 1)], [vec![0, 1, 2], vec![0, 4, 8], vec![0]]);
    assert_eq!(evenly(1000, 400).windows(2).filter(|pair| pair[0] >= pair[1]).count(), 0);
}

fn value() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>(), -1e3..1e3, 1e-9..1e-3, Just(0.0), Just(f64::NAN), Just(f64::INFINITY)]
}

fn series() -> impl Strategy<Value = Series> {
    let interval = prop::option::of((value(), value()).prop_map(|(low, high)| [low, high]));
    let dot = (value(), value(), interval, any::<String>());
    let dots = prop::collection::vec(dot.prop_map(|(x, y, interval, name)| Dot { x, y, interval, name }), 0..6);
    (any::<String>(), dots, 0..3).prop_map(|(name, dots, kind)| match kind {
        0 => Series::Dots(name, dots),
        1 => Series::Line(name, dots),
        _ => Series::Level(name, dots),
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever the numbers and the names: a page is well formed, and says every name as it is.
    #[test]
    fn any_plot_is_well_formed(series in prop::collection::vec(series(), 0..5), names in prop::array::uniform4(any::<String>()), log in any::<[bool; 2]>()) {
        let [x, y, title, word] = names;
        let drawn = Series::diagonal(&word, &series);
        let series: Vec<Series> = series.into_iter().chain([drawn]).collect();
        let plot = Plot { x: Axis { name: x, log: log[0] }, y: Axis { name: y, log: log[1] }, series };
        let figure = Figure::plot("figure", &title, &word, &plot);
        parsed(&figure.file());
        let mut matrix = Matrix::default();
        matrix.add(&title, &word);
        let mut page = Page { title: title.clone(), lead: word.clone(), figures: vec![figure, Figure::matrix("matrix", &word, "", &matrix)], ..Page::default() };
        page.fact("fact", word);
        let text = page.html();
        let page = parsed(&text);
        let heading = page.descendants().find(|node| node.tag_name().name() == "h1").map(text_of).unwrap_or_default();
        let wanted = escaped(&title);
        prop_assert_eq!(escaped(&heading), wanted);
        let numbers = page.descendants().flat_map(|node| ["transform", "points", "d"].map(|name| node.attribute(name)));
        prop_assert!(numbers.flatten().all(|numbers| !numbers.contains("NaN") && !numbers.contains("inf")));
    }
}
