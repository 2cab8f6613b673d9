//! How near matrices for engines without spectra come to measured materials, so that a change of it is noticed.

use upglow_terminal::Report as _;

use super::relight::assert_has_tables;
use crate::bispectral::shared;
use crate::commands::reduced::measure;

const DOCUMENT: &str = include_str!("../../../../../docs/rgb-engines.md");

#[test]
fn matrices_of_measured_materials_are_as_near_as_the_document_says() {
    let measured = shared();
    if measured.is_empty() {
        eprintln!(
            "skipped: matrices_of_measured_materials_are_as_near_as_the_document_says (no \
             ../shared/data/bispectral)"
        );
        return;
    }
    let report = measure(&measured);
    assert_has_tables(DOCUMENT, &report.text());
    // What the choice of the parts was asked for.
    let [ours, without_ultraviolet, ..] = &report.engines[..] else { panic!("{report:?}") };
    assert!(ours.mean <= 1.3 && ours.smooth <= 0.5, "{ours:?}");
    // Rounding only: both are exact under the contract's light.
    for engine in [ours, without_ultraviolet] {
        assert!(engine.under[0] < 1e-6, "{engine:?}");
    }
}
