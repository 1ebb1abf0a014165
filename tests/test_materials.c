/* test_materials.c - bodies of several materials within elements: what closed surfaces give a material, the interfaces
   between materials, and what is released there. Cells, copies and fragments are compared with the oracle, masses with
   the surfaces' own by exact sums. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"
#include "pieces.h"
#include "scarce.h"

enum { MATERIALS = 4 };

/* ---- bodies ---- */

static gx_material materials[MATERIALS];

static void fill_materials(void) {
    static const double young[MATERIALS] = {1e4, 1e6, 2e5, 5e4}, density[MATERIALS] = {1000, 1900, 1100, 750};
    int i;
    memset(materials, 0, sizeof materials);
    for (i = 0; i < MATERIALS; i++) {
        materials[i].elastic.young = young[i];
        materials[i].elastic.poisson = 0.4;
        materials[i].density = density[i];
    }
}

static gx_body_desc mixed_desc(const workload *w) {
    gx_body_desc desc = desc_of(w);
    fill_materials();
    desc.materials = materials;
    desc.material_count = MATERIALS;
    return desc;
}

static gx_body *mixed_body(const workload *w) {
    const gx_body_desc desc = mixed_desc(w);
    gx_body *body = NULL;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    return body;
}

/* The surfaces of a workload as a shape; the n-th gives material n. */
static gx_body *mixed_shape(const workload *w, uint32_t cells) {
    gx_surface surfaces[WL_SURFACES];
    gx_body_desc desc;
    gx_shape shape;
    gx_body *body = NULL;
    size_t i;
    memset(&desc, 0, sizeof desc);
    memset(&shape, 0, sizeof shape);
    fill_materials();
    for (i = 0; i < w->surface_count; i++) {
        surfaces[i] = surface_of(&w->surfaces[i]);
        surfaces[i].material = (uint32_t)i;
    }
    shape.surfaces = surfaces;
    shape.surface_count = w->surface_count;
    shape.cells = cells;
    desc.shape = &shape;
    desc.materials = materials;
    desc.material_count = MATERIALS;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    return body;
}

static gx_result release(gx_body *body, uint32_t a, uint32_t b, gx_cut_report *report) {
    const uint32_t pair[2] = {a, b};
    gx_cut_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.release = pair;
    desc.release_count = 1;
    return gx_body_cut(body, &desc, report, NULL);
}

/* Volumes by material; the mass of all follows from them. */
static void volumes_of(gx_body *body, double volumes[MATERIALS]) {
    const gx_view view = view_of(body);
    double mass = 0;
    size_t i;
    memset(volumes, 0, MATERIALS * sizeof *volumes);
    ck_assert(view.cell_material != NULL);
    for (i = 0; i < view.cell_count; i++) {
        ck_assert_uint_lt(view.cell_material[i], MATERIALS);
        volumes[view.cell_material[i]] += view.cell_volume[i];
    }
    for (i = 0; i < MATERIALS; i++) mass += volumes[i] * materials[i].density;
    ck_assert_msg(fabs(view.mass - mass) <= 1e-12 * mass, "mass %.17g, should be %.17g", view.mass, mass);
}

static void expect_volumes(gx_body *body, const double exact[MATERIALS], const char *what) {
    double own[MATERIALS], whole = 0;
    int i;
    volumes_of(body, own);
    for (i = 0; i < MATERIALS; i++) whole += exact[i];
    for (i = 0; i < MATERIALS; i++)
        ck_assert_msg(fabs(own[i] - exact[i]) <= 1e-12 * exact[i] + 1e-15 * whole,
                      "%s: material %d has volume %.17g, should be %.17g", what, i, own[i], exact[i]);
}

static void some_steps(gx_body *body, int count) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = 1.0 / 60;
    step.gravity[2] = -9.81;
    while (count-- > 0) ck_assert_int_eq(gx_body_step(body, &step, NULL, NULL), GX_OK);
}

/* ---- the model: parts of one material ---- */

/* Each element's parts have its cells' volumes and masses, material by material. */
static void expect_parts(gx_body *body) {
    const gx_view view = view_of(body);
    double *own = (double *)oracle_memory(NULL, 2 * MATERIALS * view.element_count, sizeof *own);
    gxs_model model;
    size_t i, k;
    memset(own, 0, 2 * MATERIALS * view.element_count * sizeof *own);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    for (i = 0; i < view.cell_count; i++)
        own[2 * (MATERIALS * view.cell_element[i] + view.cell_material[i])] += view.cell_volume[i];
    for (i = 0; i < model.element_count; i++) {
        const gxs_element *part = &model.elements[i];
        double *sum = own + 2 * (MATERIALS * part->group + part->material);
        static const int twice[10] = {1, 2, 2, 2, 1, 2, 2, 1, 2, 1};
        sum[0] -= part->weight;
        for (k = 0; k < 10; k++) sum[1] += twice[k] * part->mass[k];
        sum[1] -= part->weight * materials[part->material].density;
    }
    for (i = 0; i < 2 * MATERIALS * view.element_count; i++)
        ck_assert_msg(fabs(own[i]) <= 1e-13 * (i % 2 ? view.mass : view.volume), "part %zu is off by %g", i, own[i]);
    free(own);
}

/* ---- random scenes, beside the oracle ---- */

/* Boxes and tetrahedra that give materials, at random or on a lattice, so that some have faces in common */
static void add_random_region(workload *w, int material, int special) {
    double x[4][3];
    int k, n;
    random_point(w, x[0]);
    if (random_below(2)) {
        for (k = 0; k < 3; k++) {
            if (special) x[0][k] = random_below(3) / 2.0;
            x[1][k] = x[0][k] + (special ? (1 + random_below(2)) / 2.0 : random_real(0.1, 0.8));
        }
        wl_add_aligned_box(wl_add_surface(w, 3 + material), x[0], x[1]);
        return;
    }
    do
        for (n = 0; n < 4; n++)
            for (k = 0; k < 3; k++) x[n][k] = special ? random_below(5) / 4.0 : x[0][k] + random_real(-0.8, 0.8);
    while (gxb_orient3d(x[0], x[1], x[2], x[3]) == 0);
    n = gxb_orient3d(x[0], x[1], x[2], x[3]) > 0;
    {
        wl_surface *s = wl_add_surface(w, 3 + material);
        for (k = 0; k < 4; k++) wl_add_vertex(s, x[k]);
        for (k = 0; k < 4; k++) {
            const uint8_t *out = gxp_outward[k];
            wl_add_triangle(s, out[0], out[n ? 1 : 2], out[n ? 2 : 1]);
        }
    }
}

/* Planes, large ones and such that end inside; boxes that separate or remove what is in them */
static void add_some_cut(workload *w, int special) {
    double p[3];
    random_point(w, p);
    switch (random_below(4)) {
    case 0: add_random_plane(w, 40); break;
    case 1: add_random_plane(w, random_real(0.05, 0.5)); break;
    case 2: add_axis_plane(w, random_below(3), special ? random_below(5) / 4.0 : random_real(0, 1)); break;
    default: add_box(w, random_below(2), p[0] - 0.2, p[1] - 0.3, p[2] - 0.1, p[0] + 0.1, p[1] + 0.3, p[2] + 0.2);
    }
}

/* Volumes of cells by element and material, of fragments; copies by node */
static void expect_truth(gx_body *body, const workload *w, const oracle *truth, int cells, uint64_t seed) {
    const gx_view view = view_of(body);
    double own[MATERIALS], exact[MATERIALS], *volume, *fragments;
    size_t e, i, j, m;
    CHECK_SEED(!cells || view.cell_count == truth->cell_count, seed);
    CHECK_SEED(view.copy_count == truth->copy_count, seed);
    CHECK_SEED(view.fragment_count == truth->fragment_count, seed);
    for (e = 0; e < w->element_count; e++) {
        size_t count[MATERIALS] = {0, 0, 0, 0};
        memset(own, 0, sizeof own);
        memset(exact, 0, sizeof exact);
        for (i = 0; i < view.cell_count; i++)
            if (view.cell_element[i] == e) {
                own[view.cell_material[i]] += view.cell_volume[i];
                count[view.cell_material[i]]++;
            }
        for (i = 0; i < truth->cell_count; i++)
            if (truth->cell_element[i] == e) {
                exact[truth->cell_material[i]] += truth->cell_volume[i];
                count[truth->cell_material[i]]--;
            }
        for (m = 0; m < MATERIALS; m++)
            ck_assert_msg((!cells || count[m] == 0) &&
                              fabs(own[m] - exact[m]) <= 1e-10 * exact[m] + 1e-14 * view.volume,
                          "seed %llu: element %zu, material %zu: %.17g, should be %.17g", (unsigned long long)seed, e,
                          m, own[m], exact[m]);
    }
    for (e = 0; e < w->node_count; e++) {
        for (i = j = 0; i < view.copy_count; i++) j += view.copy_node[i] == e;
        CHECK_SEED(j == truth->node_copies[e], seed);
    }
    volume = (double *)oracle_memory(NULL, view.fragment_count, sizeof *volume);
    fragments = (double *)oracle_memory(NULL, view.fragment_count, sizeof *fragments);
    memcpy(volume, view.fragment_volume, view.fragment_count * sizeof *volume);
    memcpy(fragments, truth->fragment_volume, view.fragment_count * sizeof *fragments);
    for (i = 0; i < view.fragment_count; i++) { /* few: the nearest one */
        size_t best = i;
        for (j = i; j < view.fragment_count; j++)
            if (fabs(fragments[j] - volume[i]) < fabs(fragments[best] - volume[i])) best = j;
        CHECK_SEED(fabs(fragments[best] - volume[i]) <= 1e-10 * volume[i] + 1e-14 * view.volume, seed);
        fragments[best] = fragments[i];
    }
    free(volume);
    free(fragments);
}

/* Materials given before, with and after cuts: the same at once and in sequence, but for cells. These stay divided
   where an interface was. */
START_TEST(as_the_oracle_has_it) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w;
    oracle *truth;
    gx_body *body;
    size_t i;
    int regions, cuts;
    random_seed(seed);
    w = random_mesh();
    for (regions = 1 + random_below(3), cuts = random_below(3); regions + cuts > 0;)
        if (random_below(regions + cuts) < regions)
            add_random_region(&w, 1 + random_below(MATERIALS - 1), random_below(2)), regions--;
        else
            add_some_cut(&w, random_below(2)), cuts--;
    truth = wl_oracle(&w);
    if (truth->cell_count > 0) {
        body = mixed_body(&w);
        cut_by(body, &w, 0, w.surface_count);
        expect_truth(body, &w, truth, 1, seed);
        expect_parts(body);
        gx_body_destroy(body);
        body = mixed_body(&w);
        for (i = 0; i < w.surface_count; i++) cut_by(body, &w, i, 1);
        expect_truth(body, &w, truth, 0, seed);
        expect_parts(body);
        gx_body_destroy(body);
    }
    oracle_destroy(truth);
    wl_free(&w);
}
END_TEST

/* An interface that is released, and one along which a sheet cuts, come apart alike. */
START_TEST(released_or_cut_along) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w, walls;
    gx_body *body, *other;
    gx_cut_report report;
    size_t i;
    random_seed(seed);
    w = random_mesh();
    add_random_region(&w, 2, random_below(2));
    if (random_below(2)) add_random_cut(&w, 0);
    body = mixed_body(&w);
    other = mixed_body(&w);
    cut_by(body, &w, 0, w.surface_count);
    ck_assert_int_eq(release(body, 2, _i % 2 ? GX_ANY_MATERIAL : 0, &report), GX_OK);
    walls = wl_empty();
    for (i = 0; i < w.surface_count; i++) {
        walls.surfaces[i] = w.surfaces[i];
        if (i == 0) walls.surfaces[i].solid = 0;
    }
    cut_by(other, &w, 0, w.surface_count);
    cut_by(other, &walls, 0, 1);
    {
        const double exact = view_of(other).volume;
        double volumes[2][MATERIALS];
        int m;
        expect_same(body, other, 1, 1e-12, 1e-15, "released", seed);
        volumes_of(body, volumes[0]);
        volumes_of(other, volumes[1]);
        for (m = 0; m < MATERIALS; m++) CHECK_SEED(fabs(volumes[0][m] - volumes[1][m]) <= 1e-13 * exact, seed);
    }
    {
        const uint64_t hash = gx_body_state_hash(body); /* there is nothing left to release */
        ck_assert_int_eq(release(body, GX_ANY_MATERIAL, 2, &report), GX_OK);
        ck_assert(report.touched_elements == 0 && report.created_copies == 0);
        ck_assert(hash == gx_body_state_hash(body));
    }
    gx_body_destroy(body);
    gx_body_destroy(other);
    wl_free(&w);
}
END_TEST

/* ---- an organ: flesh, a bone and a tumour ---- */

static workload organ(void) {
    static const double flesh[3] = {0, 0, 0}, bone[3] = {0.3, 0.1, 0}, tumour[3] = {-0.45, 0, 0.1};
    workload w = wl_empty();
    add_blob(wl_add_surface(&w, 0), flesh, 1, 2, 0.05, 12, 0);
    add_blob(wl_add_surface(&w, 0), bone, 0.35, 3, 0.1, 9, 0);
    add_blob(wl_add_surface(&w, 0), tumour, 0.27, 2, 0.15, 8, 0);
    return w;
}

static void organ_volumes(const workload *w, double exact[MATERIALS]) {
    static const double middle[3] = {0, 0, 0};
    int i;
    for (i = 0; i < 3; i++) exact[i] = moments_of_surfaces(&w->surfaces[i], 1, middle).volume;
    exact[0] -= exact[1] + exact[2];
    exact[3] = 0;
}

static void cut_plane(gx_body *body, const double p[3], const double n[3]) {
    workload plane = wl_empty();
    add_plane(&plane, p, n, 9);
    cut_by(body, &plane, 0, 1);
    wl_free(&plane);
}

static gx_body *loaded(gx_body *body) {
    gx_body *other = NULL;
    size_t size;
    void *bytes;
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
    bytes = oracle_memory(NULL, size, 1);
    ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
    ck_assert_int_eq(gx_body_load(bytes, size, NULL, &other, NULL), GX_OK);
    free(bytes);
    return other;
}

/* Masses of an organ through cuts, steps, saving, loading, cloning; the tumour taken out whole */
START_TEST(masses_of_an_organ) {
    static const double p[3] = {-0.3, 0.02, 0.03}, n[3] = {0.2, 1, 0.3}, q[3] = {0.31, 0.1, 0.03}, o[3] = {1, 0.1, 0.2};
    workload w = organ();
    gx_body *body = mixed_shape(&w, 7 + 3 * (uint32_t)_i), *copies[2];
    double exact[MATERIALS];
    gx_cut_report report;
    gx_view view;
    int k;
    organ_volumes(&w, exact);
    expect_volumes(body, exact, "carved");
    expect_parts(body);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 1);
    cut_plane(body, q, o); /* through flesh and bone */
    expect_volumes(body, exact, "cut");
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    some_steps(body, 2);
    ck_assert_int_eq(release(body, 2, 0, &report), GX_OK);
    expect_volumes(body, exact, "released");
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 3);
    for (k = 0; k < 3 && fabs(view.fragment_volume[k] - exact[2]) > 1e-12 * exact[2];) k++;
    ck_assert_msg(k < 3, "the tumour is no piece");
    ck_assert(fabs(view.fragment_mass[k] - exact[2] * materials[2].density) <= 1e-12 * view.fragment_mass[k]);
    copies[0] = loaded(body);
    ck_assert_int_eq(gx_body_clone(body, &copies[1], NULL), GX_OK);
    for (k = -1; k < 2; k++) {
        gx_body *one = k < 0 ? body : copies[k];
        some_steps(one, 1);
        cut_plane(one, p, n); /* through all three */
        ck_assert_int_eq(release(one, GX_ANY_MATERIAL, GX_ANY_MATERIAL, &report), GX_OK);
        some_steps(one, 2);
        expect_volumes(one, exact, "cut again");
        expect_parts(one);
    }
    for (k = 0; k < 2; k++) {
        ck_assert(gx_body_state_hash(copies[k]) == gx_body_state_hash(body));
        ck_assert(hash_of(copies[k]) == hash_of(body));
        gx_body_destroy(copies[k]);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static double skin_area(gx_body *body, uint32_t surface, uint32_t material) {
    gx_skin skin;
    double area = 0;
    size_t t;
    memset(&skin, 0, sizeof skin);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    for (t = 0; t < skin.triangle_count; t++) {
        const uint32_t *v = skin.triangles + 3 * t;
        if (skin.triangle_surface[t] == surface && skin.triangle_material[t] == material)
            area +=
                triangle_area(skin.vertex_rest + 3 * v[0], skin.vertex_rest + 3 * v[1], skin.vertex_rest + 3 * v[2]);
    }
    return area;
}

/* An interface is not drawn. Released, it has both materials' faces, of its own surface. */
START_TEST(skins_of_an_organ) {
    workload w = organ();
    gx_body *body = mixed_shape(&w, 9);
    const double flesh = area_of(&w.surfaces[0]), tumour = area_of(&w.surfaces[2]);
    ck_assert(fabs(skin_area(body, 1, 0) - flesh) <= 1e-12 * flesh);
    ck_assert(skin_area(body, 3, 0) == 0 && skin_area(body, 3, 2) == 0 && skin_area(body, 2, 1) == 0);
    ck_assert_int_eq(release(body, 0, 2, NULL), GX_OK);
    ck_assert(fabs(skin_area(body, 1, 0) - flesh) <= 1e-12 * flesh);
    ck_assert(fabs(skin_area(body, 3, 0) - tumour) <= 1e-12 * tumour);
    ck_assert(fabs(skin_area(body, 3, 2) - tumour) <= 1e-12 * tumour);
    ck_assert(skin_area(body, 2, 0) == 0 && skin_area(body, 2, 1) == 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Peeling: within a scope of cells, only what lies in it comes apart, and the rest holds. */
START_TEST(peeled_in_two_goes) {
    workload w = organ();
    gx_body *body = mixed_shape(&w, 8);
    gx_view view = view_of(body);
    const uint32_t pair[2] = {2, GX_ANY_MATERIAL};
    uint32_t *cells = (uint32_t *)oracle_memory(NULL, view.cell_count, sizeof *cells);
    gx_cut_desc desc;
    gx_cut_report report;
    double exact[MATERIALS];
    size_t i, n = 0;
    organ_volumes(&w, exact);
    memset(&desc, 0, sizeof desc);
    desc.release = pair;
    desc.release_count = 1;
    for (i = 0; i < view.cell_count; i++) /* elements with a first node on the left */
        if (view.positions[3 * view.elements[4 * view.cell_element[i]]] < -0.45) cells[n++] = (uint32_t)i;
    ck_assert(n > 0 && n < view.cell_count);
    desc.scope_cells = cells;
    desc.scope_cell_count = n;
    ck_assert_int_eq(gx_body_cut(body, &desc, &report, NULL), GX_OK);
    ck_assert(report.created_copies > 0);
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    expect_volumes(body, exact, "half");
    some_steps(body, 1);
    ck_assert_int_eq(release(body, 0, 2, &report), GX_OK);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    expect_volumes(body, exact, "whole");
    free(cells);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Where regions overlap the last one counts; those that adjoin have one interface. */
START_TEST(overlaps_and_neighbours) {
    workload w = wl_empty();
    gx_body *body;
    double exact[MATERIALS] = {0, 0, 0, 0}, sum;
    add_bar(wl_add_surface(&w, 0), 0, 0, 0, 2, 1, 1);
    add_bar(wl_add_surface(&w, 0), 0.25, 0.25, 0.25, 1, 0.75, 0.75); /* adjoins the next but one */
    add_bar(wl_add_surface(&w, 0), 0.5, 0.5, 0.5, 1.5, 1.5, 0.75);   /* overlaps it, and sticks out */
    add_bar(wl_add_surface(&w, 0), 1, 0.25, 0.25, 1.75, 0.75, 0.75);
    exact[3] = 0.75 * 0.5 * 0.5;
    exact[2] = 1 * 1 * 0.25 - 0.5 * 0.25 * 0.25;
    exact[1] = 0.75 * 0.5 * 0.5 - 0.5 * 0.25 * 0.25;
    exact[0] = 2 - exact[3] - exact[1] - (exact[2] - 1 * 0.5 * 0.25);
    body = mixed_shape(&w, 5 + (uint32_t)_i);
    expect_volumes(body, exact, "overlapping");
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    ck_assert_int_eq(release(body, 1, 3, NULL), GX_OK); /* both still hang together with others */
    ck_assert_uint_eq(view_of(body).fragment_count, 1);
    ck_assert_int_eq(release(body, GX_ANY_MATERIAL, GX_ANY_MATERIAL, NULL), GX_OK);
    ck_assert_uint_eq(view_of(body).fragment_count, 4);
    expect_volumes(body, exact, "in four");
    sum = skin_area(body, 2, 1) + skin_area(body, 4, 3);
    ck_assert(sum > 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Materials of a mesh, element by element: they are cells' materials, and adjoin in faces. */
START_TEST(materials_of_a_mesh) {
    workload w = grid(4, 2, 2, _i % 2 ? 5 : 6);
    gx_body_desc desc = mixed_desc(&w);
    uint32_t *of = (uint32_t *)oracle_memory(NULL, w.element_count, sizeof *of);
    double exact[MATERIALS] = {0, 0, 0, 0};
    gx_body *body = NULL;
    gx_view view;
    size_t i, k;
    for (i = 0; i < w.element_count; i++) {
        double middle = 0;
        for (k = 0; k < 4; k++) middle += w.positions[3 * w.elements[4 * i + k]] / 4;
        of[i] = middle < 1 ? 1 : middle < 3 ? 0 : 3;
    }
    desc.element_materials = of;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    view = view_of(body);
    for (i = 0; i < view.cell_count; i++) ck_assert_uint_eq(view.cell_material[i], of[view.cell_element[i]]);
    ck_assert_int_eq(release(body, 1, 3, NULL), GX_OK); /* they do not adjoin */
    ck_assert_uint_eq(view_of(body).copy_count, w.node_count);
    exact[0] = 0.5 * view.volume;
    exact[1] = exact[3] = 0.25 * view.volume;
    ck_assert_int_eq(release(body, 1, 0, NULL), GX_OK);
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    ck_assert_int_eq(release(body, 3, GX_ANY_MATERIAL, NULL), GX_OK);
    ck_assert_uint_eq(view_of(body).fragment_count, 3);
    ck_assert_uint_eq(view_of(body).copy_count, w.node_count + 2 * 9);
    expect_volumes(body, exact, "a mesh");
    free(of);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* What is given another material while it moves: copies wake, the skin and the model have it. */
START_TEST(given_in_motion) {
    workload w = grid(3, 3, 3, 5), all = wl_empty();
    gx_body *body = mixed_body(&w);
    gx_view view;
    gxs_model model;
    size_t i;
    double exact[MATERIALS] = {0, 0, 0, 0};
    add_bar(wl_add_surface(&all, 3 + 2), -1, -1, -1, 4, 4, 4); /* whole elements, every one */
    add_bar(wl_add_surface(&all, 3 + 1), 0.1, 0.2, 0.1, 0.4, 0.4, 0.8);
    ck_assert(skin_area(body, GX_SKIN_OUTER, 0) > 0);
    some_steps(body, 2);
    view = view_of(body);
    for (i = 0; i < view.copy_count; i++) view.rest_time[i] = 1;
    cut_by(body, &all, 0, 1);
    view = view_of(body);
    ck_assert_uint_eq(view.cell_count, w.element_count);
    for (i = 0; i < view.copy_count; i++) ck_assert(view.rest_time[i] == 0);
    exact[2] = view.volume;
    expect_volumes(body, exact, "all");
    ck_assert(skin_area(body, GX_SKIN_OUTER, 0) == 0 && skin_area(body, GX_SKIN_OUTER, 2) > 0);
    some_steps(body, 1);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    for (i = 0; i < model.element_count; i++) ck_assert_uint_eq(model.elements[i].material, 2);
    cut_by(body, &all, 1, 1);
    exact[1] = 0.3 * 0.2 * 0.7;
    exact[2] -= exact[1];
    some_steps(body, 1);
    {
        double own[MATERIALS];
        volumes_of(body, own);
        ck_assert(fabs(own[1] - exact[1]) <= 1e-12 * exact[1] && own[0] == 0);
    }
    cut_by(body, &all, 0, 1); /* and back: cells stay divided, parts do not */
    expect_parts(body);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    ck_assert_uint_eq(model.element_count, w.element_count);
    gx_body_destroy(body);
    wl_free(&w);
    wl_free(&all);
}
END_TEST

/* Shavings off an organ, with bodies that give back memory: interfaces stay what they are. */
START_TEST(interfaces_outlast_compaction) {
    workload w = organ();
    gx_body *body = mixed_shape(&w, 6);
    double exact[MATERIALS], own[MATERIALS];
    int i, k;
    organ_volumes(&w, exact);
    for (i = 0; i < 60; i++) {
        workload tool = wl_empty();
        const double x = -1.2 + 0.012 * i;
        add_bar(wl_add_surface(&tool, 1), x - 0.5, -2, -2, x, 2, 2);
        cut_by(body, &tool, 0, 1);
        wl_free(&tool);
    }
    volumes_of(body, own);
    ck_assert(own[2] > 0 && own[2] < exact[2]);
    ck_assert(fabs(own[1] - exact[1]) <= 1e-12 * exact[1]);
    {
        gx_body *other = mixed_shape(&w, 6);
        workload tool = wl_empty();
        double once[MATERIALS];
        add_bar(wl_add_surface(&tool, 1), -9, -2, -2, -1.2 + 0.012 * 59, 2, 2);
        cut_by(other, &tool, 0, 1);
        volumes_of(other, once);
        for (k = 0; k < MATERIALS; k++) ck_assert(fabs(own[k] - once[k]) <= 1e-12 * once[k]);
        ck_assert_uint_eq(view_of(body).copy_count, view_of(other).copy_count);
        ck_assert_int_eq(release(body, 2, 0, NULL), GX_OK);
        ck_assert_int_eq(release(other, 2, 0, NULL), GX_OK);
        expect_same(body, other, 1, 1e-9, 1e-13, "shaved", 0);
        gx_body_destroy(other);
        wl_free(&tool);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- refusals ---- */

static void expect_refusal(gx_body *body, const gx_cut_desc *desc, gx_result result, const char *field, size_t index) {
    const uint64_t before = gx_body_state_hash(body);
    gx_failure failure;
    ck_assert_int_eq(gx_body_cut(body, desc, NULL, &failure), result);
    ck_assert_msg(failure.field != NULL && strcmp(failure.field, field) == 0, "field %s, should be %s", failure.field,
                  field);
    ck_assert_uint_eq(failure.index, index);
    ck_assert(before == gx_body_state_hash(body));
}

/* What is released has to be in the scope on both sides. */
START_TEST(released_on_both_sides) {
    workload w = grid(2, 1, 1, 5);
    gx_body *body = mixed_body(&w);
    const uint32_t pair[2] = {1, GX_ANY_MATERIAL};
    static uint32_t scope[256];
    gx_cut_desc desc;
    gx_view view;
    uint32_t i;
    int whole;
    add_bar(wl_add_surface(&w, 3 + 1), 0.1, 0.1, 0.1, 0.7, 0.6, 0.5);
    cut_by(body, &w, 0, 1);
    memset(&desc, 0, sizeof desc);
    desc.release = pair;
    desc.release_count = 1;
    desc.scope_cells = scope;
    for (whole = 0; whole < 2; whole++) {
        view = view_of(body);
        ck_assert_uint_eq(view.fragment_count, 1);
        ck_assert_uint_le(view.cell_count, 256);
        desc.scope_cell_count = 0;
        for (i = 0; i < view.cell_count; i++)
            if (whole || view.cell_material[i] == 1) scope[desc.scope_cell_count++] = i;
        ck_assert_uint_gt(desc.scope_cell_count, 1);
        ck_assert_int_eq(gx_body_cut(body, &desc, NULL, NULL), GX_OK);
    }
    ck_assert_uint_eq(view_of(body).fragment_count, 2);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

START_TEST(refused_materials) {
    uint32_t pairs[4] = {0, 1, 2, MATERIALS};
    workload w = grid(2, 1, 1, 5), region = wl_empty();
    gx_body_desc created = mixed_desc(&w);
    gx_body *body = mixed_body(&w), *other = NULL;
    gx_surface surface;
    gx_shape shape;
    gx_failure failure;
    gx_cut_desc desc;
    add_bar(wl_add_surface(&region, 3 + 1), 0.1, 0.1, 0.1, 0.7, 0.6, 0.5);
    surface = surface_of(&region.surfaces[0]);
    memset(&desc, 0, sizeof desc);
    desc.release_count = 2;
    expect_refusal(body, &desc, GX_ERROR_ARGUMENT, "release", SIZE_MAX);
    desc.release = pairs;
    expect_refusal(body, &desc, GX_ERROR_INDEX, "release", 1);
    desc.release_count = SIZE_MAX;
    expect_refusal(body, &desc, GX_ERROR_LIMIT, "release_count", SIZE_MAX);
    desc.release_count = 1;
    desc.surface_count = 1;
    expect_refusal(body, &desc, GX_ERROR_ARGUMENT, "surfaces", SIZE_MAX);
    desc.surface_count = 0;
    desc.surfaces = &surface;
    desc.release_count = 0;
    expect_refusal(body, &desc, GX_ERROR_EMPTY, "surface_count", SIZE_MAX);
    desc.surface_count = 1;
    surface.material = MATERIALS;
    expect_refusal(body, &desc, GX_ERROR_INDEX, "surfaces.material", SIZE_MAX);
    surface.material = 1;
    surface.kind = 4;
    expect_refusal(body, &desc, GX_ERROR_ARGUMENT, "surfaces.kind", SIZE_MAX);
    surface.kind = GX_SURFACE_MATERIAL;
    surface.triangle_count--;
    ck_assert_int_eq(gx_body_cut(body, &desc, NULL, &failure), GX_ERROR_NOT_CLOSED);
    surface.triangle_count++;
    memset(&desc, 0, sizeof desc); /* neither surfaces nor pairs */
    expect_refusal(body, &desc, GX_ERROR_ARGUMENT, "surfaces", SIZE_MAX);
    desc.surfaces = &surface;
    desc.surface_count = 1;
    gx_body_destroy(body);
    materials[1].density = 1e300; /* nothing has it yet */
    ck_assert_int_eq(gx_body_create(&created, &body, NULL), GX_OK);
    expect_refusal(body, &desc, GX_ERROR_RANGE, "surfaces.material", SIZE_MAX);
    gx_body_destroy(body);
    body = body_of(&w); /* of one material */
    expect_refusal(body, &desc, GX_ERROR_INDEX, "surfaces.material", SIZE_MAX);
    surface.material = 0;
    ck_assert_int_eq(gx_body_cut(body, &desc, NULL, NULL), GX_OK);
    ck_assert(view_of(body).cell_material == NULL && view_of(body).cell_count == w.element_count);
    gx_body_destroy(body);
    memset(&shape, 0, sizeof shape);
    shape.surfaces = &surface;
    shape.surface_count = 1;
    shape.cells = 3;
    created = desc_of(&w);
    created.positions = NULL;
    created.elements = NULL;
    created.node_count = created.element_count = 0;
    created.shape = &shape;
    surface.material = 1;
    ck_assert_int_eq(gx_body_create(&created, &other, &failure), GX_ERROR_INDEX);
    ck_assert_str_eq(failure.field, "shape.surfaces.material");
    ck_assert_uint_eq(failure.surface, 0);
    wl_free(&w);
    wl_free(&region);
}
END_TEST

/* Memory runs out while materials are given, while they are released, while a body with interfaces is cut. */
START_TEST(memory_runs_out) {
    const uint32_t pair[2] = {1, GX_ANY_MATERIAL};
    workload w = grid(2, 1, 1, 5);
    gx_surface surfaces[2];
    size_t n;
    add_bar(wl_add_surface(&w, 3 + 1), 0.1, 0.1, 0.1, 0.7, 0.6, 0.5);
    add_bar(wl_add_surface(&w, _i == 0 ? 3 + 2 : _i == 1 ? 0 : 1), 0.3, 0.3, 0.1, 0.8, 0.9, 0.9);
    surfaces[0] = surface_of(&w.surfaces[0]);
    surfaces[1] = surface_of(&w.surfaces[1]);
    for (n = 0;; n += 3 * FEWER + 1) {
        memory m = plenty();
        gx_body_desc desc = mixed_desc(&w);
        gx_cut_desc cut;
        gx_body *body = NULL;
        gx_failure failure;
        gx_result result;
        uint64_t before;
        int done;
        desc.allocator = allocator_of(&m);
        ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
        memset(&cut, 0, sizeof cut);
        cut.surfaces = surfaces;
        cut.surface_count = _i == 0 ? 2 : 1;
        if (_i > 0) {
            ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_OK);
            cut.surfaces = surfaces + 1;
        }
        cut.release = pair;
        cut.release_count = 1;
        before = gx_body_state_hash(body);
        fail_from(&m, n, (int)(n & 1));
        result = gx_body_cut(body, &cut, NULL, &failure);
        done = !m.failed;
        never_fail(&m);
        ck_assert_int_eq(result, done ? GX_OK : failure.result);
        if (result != GX_OK) {
            ck_assert_int_eq(result, GX_ERROR_MEMORY);
            ck_assert(before == gx_body_state_hash(body));
            ck_assert_int_eq(gx_body_cut(body, &cut, NULL, NULL), GX_OK);
        }
        expect_parts(body);
        gx_body_destroy(body);
        ck_assert(m.blocks == NULL && !m.wrong && !m.overrun);
        if (done) break;
    }
    wl_free(&w);
}
END_TEST

static Suite *suite(void) {
    Suite *s = suite_create("materials");
    TCase *tests = tcase_create("materials");
    tcase_set_timeout(tests, 300);
    ADD_SOME(tests, as_the_oracle_has_it, 150);
    ADD_SOME(tests, released_or_cut_along, 100);
    tcase_add_loop_test(tests, masses_of_an_organ, 0, 2);
    tcase_add_test(tests, skins_of_an_organ);
    tcase_add_test(tests, peeled_in_two_goes);
    tcase_add_loop_test(tests, overlaps_and_neighbours, 0, 2);
    tcase_add_loop_test(tests, materials_of_a_mesh, 0, 2);
    tcase_add_test(tests, given_in_motion);
    tcase_add_test(tests, interfaces_outlast_compaction);
    tcase_add_test(tests, refused_materials);
    tcase_add_test(tests, released_on_both_sides);
    tcase_add_loop_test(tests, memory_runs_out, 0, 3);
    suite_add_tcase(s, tests);
    return s;
}

int main(void) {
    const int result = run_suite(suite());
    rat_arena_free();
    return result;
}
