//! The requests about dropped files.

use std::collections::HashMap;
use std::sync::Arc;

use axum::Router;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::Uri;
use axum::routing::{get, post};
use serde_json::json;
use tempfile::TempPath;
use tokio::sync::OwnedSemaphorePermit;
use upglow_color::{BispectralUnit, Choice as _, Grid, RgbSpace};
use upglow_image::{Declared, DeclaredAlpha, Encoding, Excerpt};

use super::answer::{Refusal, binary, json as answer, work};
use super::body::{self, Limit};
use super::drops::{Dropped, light_option};
use super::spectral::SpectralDrop;
use super::{Answer, Shared, numbered};
use crate::lights::ShownLight;

/// Texels of a picture along a side that the page gets.
const PICTURE_SIDE: usize = 512;

pub(super) fn routes() -> Router<Arc<Shared>> {
    Router::new()
        .route("/{token}/picture", post(picture))
        .route("/{token}/light", post(light))
        .route("/{token}/dye", post(dye))
        .route("/{token}/spectral", post(spectral))
        .route("/{token}/drop/{item}", get(data))
        .route("/{token}/drop/{item}/pixel", get(pixel))
}

/// What follows the question mark of an address.
struct Query(HashMap<String, String>);

impl Query {
    fn of(uri: &Uri) -> Self {
        let pairs = form_urlencoded::parse(uri.query().unwrap_or_default().as_bytes());
        Self(pairs.into_owned().collect())
    }

    fn text(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    /// The name of a file; only to be shown.
    fn name(&self) -> String {
        self.text("name").unwrap_or("the file").replace(char::is_control, " ")
    }

    fn number<T: std::str::FromStr>(&self, name: &str) -> Result<T, Refusal> {
        let found = self.text(name).unwrap_or_default();
        found
            .parse()
            .map_err(|_| Refusal::bad(format!("{name}: {found:?}, expected a whole number")))
    }

    /// The number of a cube; that of the first if none is given.
    fn cube(&self) -> Result<u32, Refusal> {
        if self.text("cube").is_some() { self.number("cube") } else { Ok(0) }
    }

    /// A value that the library reads.
    fn read<T, E: ToString>(
        &self,
        name: &str,
        read: impl Fn(&str) -> Result<T, E>,
    ) -> Result<Option<T>, Refusal> {
        let found = self.text(name).map(read).transpose();
        found.map_err(|error| Refusal::bad(format!("{name}: {}", error.to_string())))
    }
}

fn little_endian(rgb: &[[f32; 3]]) -> Vec<u8> {
    rgb.iter().flatten().flat_map(|v| v.to_le_bytes()).collect()
}

/// A dropped file, and the permission to read it.
struct Received {
    turn: OwnedSemaphorePermit,
    id: u32,
    path: TempPath,
}

/// Writes a body to a file. One at a time, so that one file's memory is the most that files need.
async fn received(shared: &Shared, name: &str, body: Body) -> Result<Received, Refusal> {
    let turn = shared.files.clone().acquire_owned().await.map_err(Refusal::bad)?;
    let id = shared.drops.new_id();
    let path = shared.drops.path(id, name)?;
    body::file(body, Limit::PICTURE, path.to_path_buf()).await?;
    Ok(Received { turn, id, path })
}

async fn picture(State(shared): State<Arc<Shared>>, uri: Uri, body: Body) -> Answer {
    let query = Query::of(&uri);
    let declared = Declared {
        space: query.read("space", RgbSpace::named)?,
        encoding: query.read("encoding", str::parse::<Encoding>)?,
        alpha: query.read("alpha", DeclaredAlpha::named)?,
        layer: query.text("layer").map(String::from),
    };
    let (name, held) = (query.name(), shared.shelf.get(query.cube()?)?);
    let Received { turn, id, path } = received(&shared, &name, body).await?;
    work(move || {
        let _turn = turn;
        let refused =
            |error: &dyn ToString| Refusal::unusable(format!("{name}: {}", error.to_string()));
        let opened =
            upglow_image::Picture::open_as(&path, &declared).map_err(|error| refused(&error))?;
        super::check_size(&name, opened.size())?;
        drop(opened);
        let found = Excerpt::read(&path, &declared, held.cube.contract(), PICTURE_SIDE)
            .map_err(|error| refused(&error))?;
        let Excerpt { picture: [width, height], step, size: [columns, rows], rgb, interpretation } =
            found;
        shared.drops.add(Dropped { id, rgb: little_endian(&rgb).into(), spectra: None });
        Ok(answer(&json!({
            "id": id,
            "name": name,
            "width": width,
            "height": height,
            "step": step,
            "columns": columns,
            "rows": rows,
            "sentence": interpretation.to_string(),
            "interpretation": interpretation,
        })))
    })
    .await
}

async fn light(State(shared): State<Arc<Shared>>, uri: Uri, body: Body) -> Answer {
    let query = Query::of(&uri);
    let held = shared.shelf.get(query.cube()?)?;
    let text = body::text(body, Limit::TABLE).await?;
    work(move || {
        let light = shared.drops.add_light(&query.name(), &text)?;
        let shown = ShownLight::new(&held.cube, &light);
        let mut told = shown.description();
        let seen = &shown.seen.colorimetry;
        told["nm"] = json!(seen.wavelengths_nm());
        told["irradiance"] = json!(seen.irradiance());
        told["weights"] = json!(seen.weights());
        told["power"] = json!(shown.power);
        told["option"] = json!(light_option(light.name()));
        Ok(answer(&told))
    })
    .await
}

async fn dye(State(shared): State<Arc<Shared>>, uri: Uri, body: Body) -> Answer {
    let query = Query::of(&uri);
    let text = body::text(body, Limit::TABLE).await?;
    work(move || Ok(answer(&shared.drops.add_dye(&query.name(), &text)?))).await
}

async fn spectral(State(shared): State<Arc<Shared>>, uri: Uri, body: Body) -> Answer {
    let query = Query::of(&uri);
    let unit = query.read("unit", BispectralUnit::named)?;
    let (name, held) = (query.name(), shared.shelf.get(query.cube()?)?);
    let Received { turn, id, path } = received(&shared, &name, body).await?;
    work(move || {
        let _turn = turn;
        let colorimetry = held.cube.contract().on(Grid::FIT);
        let (spectra, told, rgb) = SpectralDrop::read(id, path, &name, unit, &colorimetry)?;
        shared.drops.add(Dropped { id, rgb: little_endian(&rgb).into(), spectra: Some(spectra) });
        Ok(answer(&told))
    })
    .await
}

async fn data(
    State(shared): State<Arc<Shared>>,
    Path((_, item)): Path<(String, String)>,
) -> Answer {
    match numbered(&item)? {
        (id, "data") => Ok(binary(shared.drops.get(id)?.rgb.clone())),
        _ => Err(Refusal::not_found("file")),
    }
}

async fn pixel(
    State(shared): State<Arc<Shared>>,
    Path((_, item)): Path<(String, String)>,
    uri: Uri,
) -> Answer {
    let query = Query::of(&uri);
    let place = [query.number("x")?, query.number("y")?];
    let (id, _) = numbered(&item)?;
    let (dropped, held) = (shared.drops.get(id)?, shared.shelf.get(query.cube()?)?);
    let turn = shared.files.clone().acquire_owned().await.map_err(Refusal::bad)?;
    work(move || {
        let _turn = turn;
        let no_spectra = || Refusal::bad("a picture without spectra, expected spectral EXR");
        let spectra = dropped.spectra.as_ref().ok_or_else(no_spectra)?;
        Ok(answer(&spectra.pixel(place, &held.cube.contract().observer)?))
    })
    .await
}
