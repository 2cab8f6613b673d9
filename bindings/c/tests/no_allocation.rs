//! Once a cube is loaded, no function allocates, whether it succeeds or fails.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use upglow::{
    Accounting, Bispectral as _, Cube, Draw, DyeModel, DyeOptions, DyeSet, Edge, FilmModel,
    FitRecord, Fluorescence, Model, Node, QuantumYield,
};
use upglow_c::*;
use upglow_color::Contract;

/// The system's allocator, which counts allocations per thread.
struct Counted;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: it hands every call on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's promise is the system's condition.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is the system's condition.
        unsafe { System.dealloc(pointer, layout) };
    }
}

#[global_allocator]
static ALLOCATOR: Counted = Counted;

fn allocations(work: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.get();
    work();
    ALLOCATIONS.get() - before
}

fn set() -> DyeSet {
    DyeSet::named("konig8").expect("built in")
}

fn of_dyes() -> Cube {
    let model = DyeModel::new(set(), DyeOptions::default()).expect("valid");
    let fluorescence = Fluorescence::Dyes { first: 2, weight: 0.3, concentration: 0.8 };
    cube(Model::Dyes(model), fluorescence)
}

fn of_a_film() -> Cube {
    let model = FilmModel::new(set(), Accounting::Photon, QuantumYield::Fixed(1.0));
    cube(Model::Film(model.expect("valid")), Fluorescence::film((2, 1.7), (5, 0.4)))
}

fn cube(model: Model, fluorescence: Fluorescence) -> Cube {
    let edge = Edge { edge_nm: 550.0, level: 0.5, slope_per_nm: 0.005 };
    let nodes = vec![Node::new(edge, fluorescence, 0.0); 8];
    Cube::new(Contract::default(), model, FitRecord::default(), 2, nodes).expect("valid")
}

fn open(cube: &Cube) -> *mut UpglowCube {
    let (bytes, mut cube) = (cube.to_bytes(), null_mut());
    // SAFETY: the pointers are those of a slice and of a variable.
    let status = unsafe { upglow_cube_from_memory(bytes.as_ptr(), bytes.len(), &raw mut cube) };
    assert_eq!(status, UpglowStatus::Ok);
    cube
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| drop(std::hint::black_box(Box::new(1)))), 1);
}

#[test]
fn nothing_is_allocated_after_the_load() {
    assert_allocates_nothing(open(&of_dyes()));
    assert_allocates_nothing(open(&of_a_film()));
}

fn assert_allocates_nothing(cube: *mut UpglowCube) {
    let mut colors = null_mut();
    // SAFETY: the pointers are those of a live cube and of a variable.
    unsafe { upglow_colors_create(cube, null(), &raw mut colors) };
    let mut matrices = null_mut();
    // SAFETY: the same.
    unsafe { upglow_matrices_create(cube, null(), &raw mut matrices) };
    let mut matrix = [0.0_f32; 16];
    let mut material = MaybeUninit::<UpglowMaterial>::uninit();
    let mut sample = MaybeUninit::<UpglowSample>::uninit();
    let (rgb, nm, u) = ([0.2_f32, 0.5, 0.7], [450.0_f32; 8], [0.9_f32, 0.5]);
    let (mut value, mut values, mut xyz) = (0.0, [0.0_f32; 8], [0.0_f32; 3]);
    let colors_of_many = [[0.2_f32, 0.5, 0.7], [0.2, f32::NAN, 0.7]];
    let mut many = [const { MaybeUninit::<UpglowMaterial>::uninit() }; 2];
    let mut statuses = [UpglowStatus::Internal; 10];
    let count = allocations(|| {
        let material_mut = material.as_mut_ptr();
        // SAFETY: the pointers are those of live handles and of variables; the first call fills
        // the material that the others read.
        statuses = unsafe {
            [
                upglow_look_up(cube, rgb.as_ptr(), material_mut),
                upglow_look_up_many(
                    cube,
                    colors_of_many.as_ptr().cast(),
                    many.as_mut_ptr().cast(),
                    many.len(),
                    null_mut(),
                ),
                upglow_reflectance(material_mut, 500.0, &raw mut value),
                upglow_reflectance_4(material_mut, nm.as_ptr(), values.as_mut_ptr()),
                upglow_reflectance_8(material_mut, nm.as_ptr(), values.as_mut_ptr()),
                upglow_albedo(material_mut, 450.0, &raw mut value),
                upglow_sample_incident(material_mut, 540.0, u.as_ptr(), sample.as_mut_ptr()),
                upglow_sample_outgoing(material_mut, 450.0, u.as_ptr(), sample.as_mut_ptr()),
                upglow_xyz(colors, rgb.as_ptr(), xyz.as_mut_ptr(), 1, null_mut()),
                upglow_reduced_matrix(matrices, rgb.as_ptr(), matrix.as_mut_ptr()),
            ]
        };
    });
    assert_eq!((count, statuses), (0, [UpglowStatus::Ok; 10]));
    // SAFETY: nobody uses them any more.
    unsafe {
        upglow_matrices_destroy(matrices);
        upglow_colors_destroy(colors);
        upglow_cube_destroy(cube);
    }
}

#[test]
fn a_failure_is_told_without_allocating() {
    let cube = open(&of_dyes());
    let mut material = MaybeUninit::<UpglowMaterial>::uninit();
    let rgb = [0.2_f32, 1.5, 0.7];
    let mut status = UpglowStatus::Ok;
    let count = allocations(|| {
        // SAFETY: the pointers are those of a live cube and of variables.
        status = unsafe { upglow_look_up(cube, rgb.as_ptr(), material.as_mut_ptr()) };
    });
    assert_eq!((count, status), (0, UpglowStatus::Outside));
    // SAFETY: the message ends with a zero byte and is not written to meanwhile.
    let message = unsafe { CStr::from_ptr(upglow_message()) };
    assert_eq!(message.to_str(), Ok("green is 1.5, expected 0 to 1, the range of the cube"));
    // SAFETY: nobody uses it any more.
    unsafe { upglow_cube_destroy(cube) };
}

/// What the functions of C say of a film: they are the library's, to the last digit.
#[test]
fn a_film_is_the_library_s() {
    let film = of_a_film();
    let (cube, table) = (open(&film), film.lookup_table());
    let mut facts = MaybeUninit::<UpglowCubeFacts>::uninit();
    // SAFETY: the pointers are those of a live cube and of a variable.
    assert_eq!(unsafe { upglow_cube_facts(cube, facts.as_mut_ptr()) }, UpglowStatus::Ok);
    // SAFETY: the call before filled them, and their text lives as long as the cube.
    let (facts, model) = unsafe {
        let facts = facts.assume_init();
        (facts, CStr::from_ptr(facts.model))
    };
    assert_eq!((facts.fluoresces, model.to_str()), (true, Ok("film")));
    let rgb = [0.2_f32, 0.5, 0.7];
    let expected = table.lookup(rgb).expect("in range");
    let mut material = MaybeUninit::<UpglowMaterial>::uninit();
    let mut sample = MaybeUninit::<UpglowSample>::uninit();
    let mut found = [0.0_f32; 5];
    // SAFETY: the pointers are those of live handles and of variables; the first call fills the
    // material that the others read.
    let (material, statuses) = unsafe {
        let material = material.as_mut_ptr();
        let statuses = [
            upglow_look_up(cube, rgb.as_ptr(), material),
            upglow_reflectance(material, 500.0, &raw mut found[0]),
            upglow_albedo(material, 450.0, &raw mut found[1]),
            upglow_reradiation(material, 450.0, 600.0, &raw mut found[2]),
            upglow_incident_pdf(material, 450.0, 600.0, &raw mut found[3]),
            upglow_outgoing_pdf(material, 450.0, 600.0, &raw mut found[4]),
        ];
        (material, statuses)
    };
    assert_eq!(statuses, [UpglowStatus::Ok; 6]);
    let answers = [
        expected.reflectance(500.0),
        expected.albedo(450.0),
        expected.reradiation_per_nm(450.0, 600.0),
        expected.incident_pdf_per_nm(450.0, 600.0),
        expected.outgoing_pdf_per_nm(450.0, 600.0),
    ];
    assert_eq!(found, answers);
    assert!(answers.iter().all(|answer| *answer > 0.0));
    let u = [0.9_f32, 0.5];
    // SAFETY: the pointers are those of a filled material and of variables.
    let sample = unsafe {
        let status = upglow_sample_incident(material, 600.0, u.as_ptr(), sample.as_mut_ptr());
        assert_eq!(status, UpglowStatus::Ok);
        sample.assume_init()
    };
    let drawn = expected.sample_incident(600.0, u).expect("it reflects and re-radiates");
    assert_eq!((sample.lambda_nm, sample.throughput), (drawn.nm, drawn.throughput));
    assert!(matches!(drawn.draw, Draw::Fluorescent { per_nm } if per_nm == sample.pdf_per_nm));
    // SAFETY: nobody uses it any more.
    unsafe { upglow_cube_destroy(cube) };
}
