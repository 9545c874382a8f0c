//! The pages of reports in a real browser. Skipped, and said so, where there is none.

use crate::Folder;
use crate::chromium::Browser;
use serde_json::{Value, json};

/// All marks that are seen have a place, within the figure.
const DRAWN: &str = "return [...document.querySelectorAll('figure svg')].every(svg => {
  const frame = svg.getBoundingClientRect();
  const shapes = [...svg.querySelectorAll('.mark:not(.off), .cell')].map(shape => shape.getBoundingClientRect());
  const within = box => box.width > 0 && box.left >= frame.left && box.right <= frame.right && box.top >= frame.top && box.bottom <= frame.bottom;
  return shapes.length > 0 && shapes.every(within);
});";

#[test]
fn pages_work_in_a_browser() {
    let Some(browser) = Browser::start() else {
        eprintln!("skipped: chromedriver and chromium are not installed");
        return;
    };
    let folder = Folder::new();
    for name in folder.pages().keys() {
        browser.visit(&format!("file://{}", folder.path(&format!("{name}.html")).display()));
        browser.looks(DRAWN);
        axes(&browser, name);
        legend(&browser, name);
        tips(&browser);
        assert_eq!(browser.console(), json!([]), "{name}: nothing is told on the console");
    }
    // That the console is heard at all.
    browser.run("console.error('heard')");
    assert!(browser.console().to_string().contains("heard"));
}

/// Both axes of every plot go to the other scale and back: what is drawn moves, and stands again where it stood.
fn axes(browser: &Browser, name: &str) {
    let boxes = browser.run("return document.querySelectorAll('.controls input').length").as_u64().expect("a number");
    let shown = browser.run("return [...document.querySelectorAll('.controls')].every(controls => !controls.hidden)");
    assert_eq!(shown, json!(true));
    assert_eq!(boxes > 0, name != "evaluate", "{name}");
    let mut moved = 0;
    for i in 0..boxes {
        let state = format!(
            "const figure = document.querySelectorAll('.controls input')[{i}].closest('figure');
             return [...figure.querySelectorAll('.mark:not(.off), .axis:not(.off), .line, .interval')].map(part => ['class', 'transform', 'points', 'd'].map(name => part.getAttribute(name)).join()).join(';')"
        );
        let click =
            format!("const box = document.querySelectorAll('.controls input')[{i}]; box.click(); return box.disabled");
        let before = browser.run(&state);
        if browser.run(&click) == json!(true) {
            continue;
        }
        assert_ne!(browser.run(&state), before, "{name}: axis {i}");
        browser.holds(DRAWN);
        browser.run(&click);
        assert_eq!(browser.run(&state), before, "{name}: axis {i}");
        moved += 1;
    }
    assert!(boxes == 0 || moved > boxes / 2, "{name}: {moved} of {boxes} axes");
}

/// A key hides its series by mouse and by keyboard, and shows it again.
fn legend(browser: &Browser, name: &str) {
    let press = "const key = document.querySelector('.key'); if (!key) return null;
      const series = key.closest('svg').querySelector('.series');
      const seen = () => getComputedStyle(series).display !== 'none';
      const states = [seen()];
      key.dispatchEvent(new MouseEvent('click', { bubbles: true })); states.push(seen());
      key.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter', bubbles: true })); states.push(seen());
      return states;";
    let states = browser.run(press);
    assert_eq!(states, if name == "evaluate" { Value::Null } else { json!([true, false, true]) }, "{name}");
}

/// Pointing at a mark tells its numbers.
fn tips(browser: &Browser) {
    browser.holds(
        "const mark = document.querySelector('.mark:not(.off), .cell'), tip = document.getElementById('tip');
         mark.dispatchEvent(new PointerEvent('pointermove', { bubbles: true, clientX: 40, clientY: 40 }));
         const shown = !tip.hidden && tip.textContent === mark.dataset.tip && /[0-9]/.test(tip.textContent);
         mark.closest('svg').dispatchEvent(new PointerEvent('pointerleave'));
         return shown && tip.hidden;",
    );
}
