//! From TOML to a checked [`Case`].

use std::path::Path;

use super::document::Document;
use super::error::{CaseError, Place};
use super::material::{MAGNITUDES, read_material};
use super::reader::Reader;
use super::settings::CONTACT_RADII;
use super::{
    Case, Contact, Equator, Fields, Friction, Linear, Material, Mesh, Opponent, Output, PictureFormat, Solver, Sphere,
    UnitLabels, estimate, hints, opponent, path, pictures,
};
use crate::bounded;
use crate::mesh::{FINE_ZONES, FINEST_SURFACE, FIRST_LAYERS};

/// Times as many elements as inside that there may be along the contact radius at the surface.
const SKINS: [usize; 4] = [1, 2, 4, 8];

/// The tables of a case.
const CASE_TABLES: [&str; 9] = ["sphere", "material", "contact", "opponent", "mesh", "solver", "output", "units", "path"];

impl Case {
    /// Reads a case file, applies the `--set` arguments (`key=value`, in order) and checks the
    /// result.
    pub fn load(file: &Path, settings: &[String]) -> Result<Self, CaseError> {
        let name = file.display().to_string();
        let text = bounded::read_to_string(file, bounded::CASE)
            .map_err(|source| CaseError::Unreadable { file: name.clone(), source })?;
        Self::parse(&text, &name, settings)
    }

    /// [`Case::load`] for a text in memory; `file` is the name that errors give.
    pub fn parse(text: &str, file: &str, settings: &[String]) -> Result<Self, CaseError> {
        let mut document = Document::parse(text, file)?;
        document.set_arguments(settings)?;
        Self::from_document(&document)
    }

    /// Gives the keys of a document their meaning and checks them.
    pub fn from_document(document: &Document) -> Result<Self, CaseError> {
        let case = Self::of_any_size(document)?;
        estimate::check_memory(&case, &Reader::new(document)?)?;
        Ok(case)
    }

    /// The same for a case that may need more memory than it may take.
    pub(super) fn of_any_size(document: &Document) -> Result<Self, CaseError> {
        let root = Reader::new(document)?;
        root.only(&CASE_TABLES)?;
        let sphere = read_sphere(&root.require_table("sphere", "a table with radius")?)?;
        let material = read_material_of(&root)?;
        let opponent = opponent::read(&root, &sphere, &material)?;
        let contact = read_contact(&root.require_table("contact", "a table with friction")?)?;
        let case = Case {
            mesh: read_mesh(&root.table("mesh")?, sphere.radius)?,
            solver: read_solver(&root.table("solver")?)?,
            output: read_output(&root.table("output")?)?,
            units: UnitLabels::read(&root.table("units")?)?,
            path: path::read(&root, &sphere, opponent.as_ref(), contact.friction)?,
            opponent,
            sphere,
            material,
            contact,
        };
        if let (Some(Opponent::Equal | Opponent::Deforming { .. }), Linear::Direct, Some(field)) =
            (&case.opponent, case.solver.linear, root.table("solver")?.get("linear"))
        {
            return Err(
                field.refuse("is \"direct\", which solves for one body alone", "\"multigrid\" with an opponent that deforms")
            );
        }
        check_deepest(&case, &root)?;
        check_equator(&case, &root)?;
        Ok(case)
    }

    /// A case from a table with the keys of a case file.
    ///
    /// # Errors
    /// Those of a case file, with the key; they name no line.
    pub fn from_table(table: &toml::Table) -> Result<Self, CaseError> {
        Self::from_document(&Document::from_table(table))
    }

    /// Holds a case that a program has put together, or changed, to the rules of a case file.
    ///
    /// ```
    /// use asperity::{Case, case::Friction};
    /// # let text = include_str!("../../fixtures/cases/ideal.toml");
    /// let mut case = Case::parse(text, "ideal.toml", &[])?;
    /// case.contact.friction = Friction::Coefficient(-0.1);
    /// let error = case.validate().unwrap_err().to_string();
    /// assert_eq!(error, "case: contact.friction: is -0.1. Allowed: a number >= 0, or \"stick\"");
    /// # Ok::<(), asperity::case::CaseError>(())
    /// ```
    ///
    /// # Errors
    /// Those of a case file, with the key; they name no line.
    pub fn validate(&self) -> Result<(), CaseError> {
        let table =
            toml::Table::try_from(self).map_err(|error| CaseError::Syntax { place: Place::Given, what: error.to_string() })?;
        Self::from_table(&table).map(drop)
    }
}

impl Material {
    /// Reads the `[material]` table of a TOML file, a whole case or a material alone, and applies
    /// the `--set` arguments; the other tables are not looked at.
    pub fn load(file: &Path, settings: &[String]) -> Result<Self, CaseError> {
        let name = file.display().to_string();
        let text = bounded::read_to_string(file, bounded::CASE)
            .map_err(|source| CaseError::Unreadable { file: name.clone(), source })?;
        let mut document = Document::parse(&text, &name)?;
        for argument in settings {
            document.set_argument(argument)?;
            refuse_unknown_table(argument)?;
        }
        read_material_of(&Reader::new(&document)?)
    }
}

/// Refuses a path whose contact, an elastic one at its greatest indentation, is smaller than the
/// smallest that is meshed for.
fn check_deepest(case: &Case, root: &Reader<'_>) -> Result<(), CaseError> {
    let Some((at, deepest)) = case.deepest_press() else { return Ok(()) };
    let least = case.least_indentation();
    if deepest >= least * (1.0 - 1e-12) {
        return Ok(());
    }
    let segments = root.require("path", "a path")?.array("a path")?;
    let field = segments[at].table()?.require("indentation", "a length")?;
    let allowed = format!(
        "a greatest indentation of {least:?} or more: there the contact radius is {} R, the smallest that is meshed for",
        CONTACT_RADII.0
    );
    Err(field.refuse(&format!("is {deepest:?}, the greatest of the path"), &allowed))
}

/// Refuses a free equator where another body is meshed, which is held by a plate of its own.
fn check_equator(case: &Case, root: &Reader<'_>) -> Result<(), CaseError> {
    let what = match case.opponent {
        Some(Opponent::Deforming { .. }) => "is \"free\" in a contact of two bodies that are both meshed",
        Some(Opponent::Equal) if case.image().is_none() => "is \"free\" on a path for which both spheres are meshed",
        _ if case.sphere.flat => "is \"free\", and a flat has none",
        _ => return Ok(()),
    };
    let allowed = "\"clamped\"; \"free\" for a sphere on a rigid plane, on a rigid sphere, or on an equal one";
    let field = root.table("sphere")?.get("equator");
    let free = field.filter(|_| case.sphere.equator == Equator::Free);
    free.map_or(Ok(()), |field| Err(field.refuse(what, allowed)))
}

/// Refuses a `--set` argument that sets nothing of a case. The file may have tables of other
/// programs; what is typed is meant for this one.
fn refuse_unknown_table(argument: &str) -> Result<(), CaseError> {
    let key = argument.split('=').next().unwrap_or_default().trim();
    let first = key.split('.').next().unwrap_or_default();
    if CASE_TABLES.contains(&first) {
        return Ok(());
    }
    Err(CaseError::UnknownKey {
        place: Place::Set(key.into()),
        key: first.to_owned(),
        nearest: hints::key_meant(first, "", &CASE_TABLES, ""),
        allowed: CASE_TABLES.join(", "),
    })
}

fn read_material_of(root: &Reader<'_>) -> Result<Material, CaseError> {
    read_material(&root.require_table("material", "a table with youngs_modulus, poissons_ratio, hardening")?)
}

fn read_sphere(table: &Reader<'_>) -> Result<Sphere, CaseError> {
    table.only(&["radius", "flat", "equator"])?;
    let length = "a length > 0 (from 1e-75 to 1e75)";
    let radius = table.require("radius", length)?.number(length, |radius| MAGNITUDES.contains(&radius))?;
    let flat = table.get("flat").map_or(Ok(false), |flat| flat.boolean())?;
    let equator = match table.get("equator") {
        Some(equator) => equator.choice(&[("clamped", Equator::Clamped), ("free", Equator::Free)])?,
        None => Equator::default(),
    };
    Ok(Sphere { radius, flat, equator })
}

fn read_contact(table: &Reader<'_>) -> Result<Contact, CaseError> {
    table.only(&["friction"])?;
    let allowed = "a number >= 0, or \"stick\"";
    let field = table.require("friction", allowed)?;
    let friction = match field.text() {
        Some("stick") => Friction::Stick,
        Some(other) => return Err(field.unknown_word(other, &["stick"], allowed)),
        None => Friction::Coefficient(field.number(allowed, |mu| mu >= 0.0)?),
    };
    Ok(Contact { friction })
}

fn read_mesh(table: &Reader<'_>, radius: f64) -> Result<Mesh, CaseError> {
    table.only(&[
        "elements_per_contact_radius",
        "surface_elements_per_contact_radius",
        "first_layer_thickness",
        "fine_zone",
        "contact_radius",
    ])?;
    let mut mesh = Mesh::default();
    let inside = table.get("elements_per_contact_radius").map(|field| field.count(4..=32)).transpose()?;
    let surface = table.get("surface_elements_per_contact_radius");
    if let Some(elements) = inside {
        mesh = mesh.uniform(elements);
    }
    if let Some(field) = surface {
        let at_surface = field.count(4..=FINEST_SURFACE)?;
        let elements = mesh.elements_per_contact_radius;
        let allowed: Vec<usize> = SKINS.iter().map(|by| by * elements).filter(|&n| n <= FINEST_SURFACE).collect();
        if !allowed.contains(&at_surface) {
            let named = allowed.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
            let by_default = if inside.is_some() { "" } else { " by default" };
            let problem = format!("is {at_surface}, where elements_per_contact_radius is {elements}{by_default}");
            return Err(field.refuse(&problem, &format!("{named}: once, twice, four or eight times as many")));
        }
        mesh.surface_elements_per_contact_radius = Some(at_surface).filter(|&n| n != elements);
    }
    if let Some(field) = table.get("first_layer_thickness") {
        mesh.first_layer_thickness = Some(field.number("a number from 0.5 to 1.5", |ratio| FIRST_LAYERS.contains(&ratio))?);
    }
    if let Some(field) = table.get("fine_zone") {
        mesh.fine_zone = field.number("a number from 1.1 to 3", |ratio| FINE_ZONES.contains(&ratio))?;
    }
    if let Some(field) = table.get("contact_radius") {
        let (smallest, largest) = CONTACT_RADII;
        let allowed = format!("a length from {smallest} to {largest} radius, {:?} to {:?}", smallest * radius, largest * radius);
        mesh.contact_radius = Some(field.number(&allowed, |a| (smallest..=largest).contains(&(a / radius)))?);
    }
    Ok(mesh)
}

fn read_solver(table: &Reader<'_>) -> Result<Solver, CaseError> {
    table.only(&[
        "linear",
        "tolerance",
        "press_steps",
        "shear_steps",
        "max_iterations",
        "max_cutbacks",
        "error_estimate",
        "max_memory_gib",
    ])?;
    let mut solver = Solver::default();
    if let Some(field) = table.get("linear") {
        solver.linear = field.choice(&[("multigrid", Linear::Multigrid), ("direct", Linear::Direct)])?;
    }
    if let Some(field) = table.get("tolerance") {
        solver.tolerance = field.number("a number > 1e-12 and <= 1e-2", |tolerance| tolerance > 1e-12 && tolerance <= 1e-2)?;
    }
    if let Some(field) = table.get("press_steps") {
        solver.press_steps = Some(field.count(1..=100_000)?);
    }
    if let Some(field) = table.get("shear_steps") {
        solver.shear_steps = Some(field.count(1..=100_000)?);
    }
    if let Some(field) = table.get("max_iterations") {
        solver.max_iterations = field.count(1..=1000)?;
    }
    if let Some(field) = table.get("max_cutbacks") {
        solver.max_cutbacks = field.count(0..=30)?;
    }
    if let Some(field) = table.get("error_estimate") {
        solver.error_estimate = field.boolean()?;
    }
    if let Some(field) = table.get("max_memory_gib") {
        solver.max_memory_gib = Some(field.number("a number > 0, in GiB", |gib| gib > 0.0)?);
    }
    Ok(solver)
}

fn read_output(table: &Reader<'_>) -> Result<Output, CaseError> {
    table.only(&["fields", "plots", "plot_format", "plot_width", "parquet", "keep_checkpoint"])?;
    let mut output = Output::default();
    if let Some(field) = table.get("fields") {
        output.fields = field.choice(&Fields::ALL)?;
    }
    if let Some(field) = table.get("plots") {
        output.plots = field.boolean()?;
    }
    if let Some(field) = table.get("plot_format") {
        output.plot_format = field.choice(&PictureFormat::ALL.map(|format| (format.ending(), format)))?;
    }
    output.plot_width = table.get("plot_width").map(|field| pictures::read_width(&field)).transpose()?;
    if let Some(field) = table.get("parquet") {
        output.parquet = field.boolean()?;
    }
    if let Some(field) = table.get("keep_checkpoint") {
        output.keep_checkpoint = field.boolean()?;
    }
    Ok(output)
}
