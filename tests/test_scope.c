/* test_scope.c - cells by slot: a slot names a cell across cuts and tells from which it was divided; each surface of a
   cut may have a scope of its own, given by slots. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"

/* ---- cuts by slots ---- */

typedef struct slots {
    uint32_t slot[4096];
    size_t count;
} slots;

static gx_surface surface_in(const wl_surface *s, const slots *scope) {
    gx_surface surface = surface_of(s);
    surface.scope_slots = scope->slot;
    surface.scope_slot_count = scope->count;
    return surface;
}

static gx_result cut_surfaces(gx_body *body, const gx_surface *surfaces, size_t count, gx_failure *failure) {
    gx_cut_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = surfaces;
    desc.surface_count = count;
    return gx_body_cut(body, &desc, NULL, failure);
}

/* The slot that a cell had when there were `before` slots */
static uint32_t slot_before(const gx_view *view, uint32_t slot, size_t before) {
    while (slot >= before) slot = view->slot_parent[slot];
    return slot;
}

static int contains(const slots *s, uint32_t slot) {
    size_t i;
    for (i = 0; i < s->count; i++)
        if (s->slot[i] == slot) return 1;
    return 0;
}

/* Some of the cells */
static void choose(const gx_view *view, slots *chosen, int one_in) {
    size_t i;
    chosen->count = 0;
    ck_assert_uint_le(view->cell_count, 4096);
    for (i = 0; i < view->cell_count; i++)
        if (random_below(one_in) == 0) chosen->slot[chosen->count++] = view->cell_slot[i];
}

/* Cuts by a surface, with the scope as indices of the view. */
static void cut_in_cells(gx_body *body, const wl_surface *s, const slots *scope, size_t before) {
    gx_surface surface = surface_of(s);
    const gx_view view = view_of(body);
    gx_cut_desc desc;
    uint32_t cells[4096];
    size_t i;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = &surface;
    desc.surface_count = 1;
    desc.scope_cells = cells;
    for (i = 0; i < view.cell_count; i++)
        if (contains(scope, slot_before(&view, view.cell_slot[i], before)))
            cells[desc.scope_cell_count++] = (uint32_t)i;
    if (desc.scope_cell_count > 0) ck_assert_int_eq(gx_body_cut(body, &desc, NULL, NULL), GX_OK);
}

static gx_body *clone_of(gx_body *body) {
    gx_body *clone = NULL;
    ck_assert_int_eq(gx_body_clone(body, &clone, NULL), GX_OK);
    return clone;
}

/* A mesh of some elements, cut here and there */
static gx_body *random_body(workload *w, int cuts) {
    gx_body *body;
    *w = grid(2, 2, 1 + (size_t)random_below(2), random_below(2) ? 5 : 6);
    body = body_of(w);
    while (cuts-- > 0) {
        add_random_cut(w, 1);
        cut_by(body, w, w->surface_count - 1, 1);
    }
    return body;
}

/* Surfaces with scopes of their own, in one cut or one after the other: the same cells and copies. Scopes may have
   cells in common. */
START_TEST(one_cut_or_several) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w;
    gx_body *at_once, *in_turn;
    gx_surface surfaces[3];
    slots scope[3];
    gx_view view;
    size_t before, i;
    random_seed(seed);
    at_once = random_body(&w, random_below(3));
    in_turn = clone_of(at_once);
    view = view_of(at_once);
    before = view.slot_count;
    for (i = 0; i < 3; i++) {
        add_random_cut(&w, 1);
        choose(&view, &scope[i], 1 + random_below(3));
        surfaces[i] = surface_in(&w.surfaces[w.surface_count - 1], &scope[i]);
    }
    ck_assert_int_eq(cut_surfaces(at_once, surfaces, 3, NULL), GX_OK);
    for (i = 0; i < 3; i++) cut_in_cells(in_turn, &w.surfaces[w.surface_count - 3 + i], &scope[i], before);
    CHECK_SEED(hash_of(at_once) == hash_of(in_turn), seed);
    CHECK_SEED(fabs(view_of(at_once).volume - view_of(in_turn).volume) < 1e-12, seed);
    gx_body_destroy(at_once);
    gx_body_destroy(in_turn);
    wl_free(&w);
}
END_TEST

/* Surfaces with and without scopes of their own in a cut that has one */
START_TEST(own_scopes_beside_that_of_the_cut) {
    const uint64_t seed = (uint64_t)_i + 1;
    const uint32_t fragment = 0;
    workload w;
    gx_body *at_once, *in_turn;
    gx_surface surfaces[4];
    slots scope[4];
    gx_cut_desc desc;
    gx_view view;
    size_t before, i, j;
    random_seed(seed);
    at_once = random_body(&w, 2);
    view = view_of(at_once);
    if (view.cell_count == 0) {
        gx_body_destroy(at_once);
        wl_free(&w);
        return;
    }
    in_turn = clone_of(at_once);
    before = view.slot_count;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = surfaces;
    desc.surface_count = 4;
    desc.scope_fragments = &fragment;
    desc.scope_fragment_count = 1;
    for (i = 0; i < 4; i++) {
        add_random_cut(&w, 1);
        choose(&view, &scope[i], 2);
        surfaces[i] = surface_in(&w.surfaces[w.surface_count - 1], &scope[i]);
        if (random_below(2)) continue;
        surfaces[i].scope_slots = NULL;
        surfaces[i].scope_slot_count = scope[i].count = 0;
        for (j = 0; j < view.cell_count; j++)
            if (view.cell_fragment[j] == fragment) scope[i].slot[scope[i].count++] = view.cell_slot[j];
    }
    ck_assert_int_eq(gx_body_cut(at_once, &desc, NULL, NULL), GX_OK);
    for (i = 0; i < 4; i++) cut_in_cells(in_turn, &w.surfaces[w.surface_count - 4 + i], &scope[i], before);
    CHECK_SEED(hash_of(at_once) == hash_of(in_turn), seed);
    gx_body_destroy(at_once);
    gx_body_destroy(in_turn);
    wl_free(&w);
}
END_TEST

/* ---- solids ---- */

/* By slot: volumes of what is left of each cell of before */
static void left_of_slots(gx_body *body, size_t before, double *left) {
    const gx_view view = view_of(body);
    size_t i;
    for (i = 0; i < before; i++) left[i] = 0;
    for (i = 0; i < view.cell_count; i++) left[slot_before(&view, view.cell_slot[i], before)] += view.cell_volume[i];
}

/* In cells of its scope a solid removes what it removes without a scope, in others nothing. The body may have pieces
   that lie in the solid as a whole, with none of its surface near. */
START_TEST(solids_remove_in_their_scope_only) {
    const uint64_t seed = (uint64_t)_i + 1;
    double before[4096], all[4096], some[4096];
    workload w;
    gx_body *body, *other;
    wl_frame f = wl_rotated();
    gx_surface surface;
    slots scope;
    gx_view view;
    size_t count, i;
    int k;
    random_seed(seed);
    body = random_body(&w, 3);
    other = clone_of(body);
    for (k = 0; k < 3; k++) f.origin[k] = random_real(0, 2);
    wl_add_box(wl_add_surface(&w, 1 + _i % 2), &f, random_real(0.1, 3), random_real(0.1, 3), random_real(0.1, 3));
    view = view_of(body);
    count = view.slot_count;
    ck_assert_uint_le(count, 4096);
    choose(&view, &scope, 2);
    left_of_slots(body, count, before);
    cut_by(other, &w, w.surface_count - 1, 1);
    left_of_slots(other, count, all);
    surface = surface_in(&w.surfaces[w.surface_count - 1], &scope);
    ck_assert_int_eq(cut_surfaces(body, &surface, 1, NULL), GX_OK);
    left_of_slots(body, count, some);
    for (i = 0; i < count; i++) {
        const double should = contains(&scope, (uint32_t)i) ? all[i] : before[i];
        ck_assert_msg(fabs(some[i] - should) <= 1e-12, "seed %llu: of slot %zu %.17g is left, should be %.17g of %.17g",
                      (unsigned long long)seed, i, some[i], should, before[i]);
    }
    gx_body_destroy(body);
    gx_body_destroy(other);
    wl_free(&w);
}
END_TEST

/* A box around the body touches nothing of it. One of the two halves is in the scope, and goes. */
START_TEST(a_piece_that_the_surface_does_not_touch) {
    workload w = grid(2, 2, 2, 5);
    gx_body *body = body_of(&w);
    gx_surface box;
    slots scope;
    gx_view view;
    size_t i;
    add_axis_plane(&w, 0, 0.75);
    add_box(&w, 1, -1, -1, -1, 3, 3, 3);
    cut_by(body, &w, 0, 1);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 2);
    for (i = scope.count = 0; i < view.cell_count; i++)
        if (view.cell_fragment[i] == 1) scope.slot[scope.count++] = view.cell_slot[i];
    box = surface_in(&w.surfaces[1], &scope);
    ck_assert_int_eq(cut_surfaces(body, &box, 1, NULL), GX_OK);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 1);
    ck_assert(fabs(view.volume - 3) < 1e-12 || fabs(view.volume - 5) < 1e-12);
    for (i = 0; i < scope.count; i++) ck_assert_uint_eq(gxp_kept_cell(body, scope.slot[i]), GXB_NONE);
    /* slots of what is gone stand for nothing, and keep their parents */
    w.surfaces[1].solid = 0;
    add_axis_plane(&w, 1, 0.6);
    box = surface_in(&w.surfaces[2], &scope);
    {
        const uint64_t topology = hash_of(body);
        const size_t slot_count = view.slot_count;
        ck_assert_int_eq(cut_surfaces(body, &box, 1, NULL), GX_OK);
        ck_assert(hash_of(body) == topology);
        ck_assert_uint_eq(view_of(body).slot_count, slot_count);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- slots ---- */

static void expect_slots(const gx_view *view, uint64_t seed) {
    uint8_t *seen = (uint8_t *)calloc(view->slot_count, 1);
    size_t i;
    for (i = 0; i < view->cell_count; i++) {
        const uint32_t slot = view->cell_slot[i];
        CHECK_SEED(slot < view->slot_count && !seen[slot], seed);
        seen[slot] = 1;
        CHECK_SEED(slot_before(view, slot, view->element_count) == view->cell_element[i], seed);
    }
    for (i = 0; i < view->slot_count; i++)
        CHECK_SEED(i < view->element_count ? view->slot_parent[i] == i : view->slot_parent[i] < i, seed);
    free(seen);
}

/* After each cut: what was a cell's is its descendants'. If anything is left of it, the cell's own slot is. */
START_TEST(slots_after_many_cuts) {
    const uint64_t seed = (uint64_t)_i + 1;
    double before[4096], left[4096];
    workload w;
    gx_body *body;
    gx_view view;
    int cut;
    random_seed(seed);
    body = random_body(&w, 0);
    for (cut = 0; cut < 12; cut++) {
        const int solid = random_below(2);
        uint8_t *kept;
        gx_cut_report report;
        size_t count, i;
        view = view_of(body);
        count = view.slot_count;
        ck_assert_uint_le(count, 4096);
        left_of_slots(body, count, before);
        add_random_cut(&w, solid);
        report = cut_by(body, &w, w.surface_count - 1, 1);
        view = view_of(body);
        expect_slots(&view, seed);
        CHECK_SEED(view.slot_count == count + report.created_cells, seed);
        left_of_slots(body, count, left);
        kept = (uint8_t *)calloc(view.slot_count, 1);
        for (i = 0; i < view.cell_count; i++) kept[view.cell_slot[i]] = 1;
        for (i = 0; i < count; i++) {
            CHECK_SEED(left[i] <= before[i] + 1e-12, seed);
            if (report.removed_volume == 0) CHECK_SEED(fabs(left[i] - before[i]) < 1e-12, seed);
        }
        for (i = 0; i < view.cell_count; i++) CHECK_SEED(kept[slot_before(&view, view.cell_slot[i], count)], seed);
        for (i = count; i < view.slot_count; i++) CHECK_SEED(view.slot_parent[i] < count, seed);
        free(kept);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Slots outlive saving and cloning; a body that goes back to a clone has the clone's. */
START_TEST(slots_of_copies) {
    const uint64_t seed = (uint64_t)_i + 1;
    workload w;
    gx_body *body, *clone, *read = NULL;
    unsigned char *bytes;
    gx_surface surface;
    slots scope;
    gx_view view, other;
    uint64_t state, cut;
    size_t size = 0;
    random_seed(seed);
    body = random_body(&w, 4);
    view = view_of(body);
    choose(&view, &scope, 2);
    ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
    bytes = (unsigned char *)malloc(size);
    ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
    ck_assert_int_eq(gx_body_load(bytes, size, NULL, &read, NULL), GX_OK);
    clone = clone_of(body);
    other = view_of(read);
    expect_slots(&other, seed);
    CHECK_SEED(other.slot_count == view.slot_count, seed);
    CHECK_SEED(memcmp(other.slot_parent, view.slot_parent, view.slot_count * sizeof *view.slot_parent) == 0, seed);
    CHECK_SEED(view.cell_count == 0 ||
                   memcmp(other.cell_slot, view.cell_slot, view.cell_count * sizeof *view.cell_slot) == 0,
               seed);
    add_random_cut(&w, 1);
    surface = surface_in(&w.surfaces[w.surface_count - 1], &scope);
    state = gx_body_state_hash(clone);
    ck_assert_int_eq(cut_surfaces(body, &surface, 1, NULL), GX_OK);
    ck_assert_int_eq(cut_surfaces(read, &surface, 1, NULL), GX_OK);
    cut = gx_body_state_hash(body);
    CHECK_SEED(gx_body_state_hash(read) == cut, seed);
    ck_assert_int_eq(gx_body_restore(body, clone, NULL), GX_OK);
    CHECK_SEED(gx_body_state_hash(body) == state, seed);
    other = view_of(body);
    CHECK_SEED(other.slot_count == view_of(clone).slot_count, seed);
    ck_assert_int_eq(cut_surfaces(body, &surface, 1, NULL), GX_OK);
    CHECK_SEED(gx_body_state_hash(body) == gx_body_state_hash(read), seed);
    free(bytes);
    gx_body_destroy(body);
    gx_body_destroy(clone);
    gx_body_destroy(read);
    wl_free(&w);
}
END_TEST

/* Bodies that were cut in other scopes have another epoch. */
START_TEST(epochs) {
    workload w = grid(1, 1, 1, 5);
    gx_body *a = body_of(&w), *b = body_of(&w);
    slots all = {{0, 1, 2, 3, 4}, 5}, turned = {{4, 3, 2, 1, 0}, 5};
    gx_surface surface;
    add_axis_plane(&w, 0, 0.5);
    surface = surface_in(&w.surfaces[0], &all);
    ck_assert_int_eq(cut_surfaces(a, &surface, 1, NULL), GX_OK);
    surface = surface_in(&w.surfaces[0], &turned);
    ck_assert_int_eq(cut_surfaces(b, &surface, 1, NULL), GX_OK);
    ck_assert(hash_of(a) == hash_of(b));
    ck_assert(view_of(a).epoch != view_of(b).epoch);
    gx_body_destroy(a);
    gx_body_destroy(b);
    wl_free(&w);
}
END_TEST

/* A parent that cannot be is found when bytes are read. */
START_TEST(parents_that_cannot_be) {
    static const uint32_t wrong[3] = {5, 2, UINT32_MAX}; /* itself, of another element, none */
    workload w = grid(1, 1, 1, 5);
    gx_body *body;
    int i;
    add_axis_plane(&w, 2, 0.5);
    body = cut_at_once(&w);
    ck_assert_uint_gt(body->cells.count, 5);
    ck_assert_uint_ne(body->cells.data[5].element, wrong[1]);
    for (i = 0; i < 4; i++) {
        const uint32_t slot = i < 3 ? 5 : 1, right = body->slots.parent[slot];
        gx_body *read = NULL;
        unsigned char *bytes;
        size_t size = 0;
        body->slots.parent[slot] = i < 3 ? wrong[i] : 0;
        ck_assert_int_eq(gx_body_save(body, NULL, 0, &size, NULL), GX_OK);
        bytes = (unsigned char *)malloc(size);
        ck_assert_int_eq(gx_body_save(body, bytes, size, &size, NULL), GX_OK);
        ck_assert_int_eq(gx_body_load(bytes, size, NULL, &read, NULL), GX_ERROR_DAMAGED);
        body->slots.parent[slot] = right;
        free(bytes);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- what is refused, what it costs ---- */

START_TEST(refused_slots) {
    workload w = grid(2, 1, 1, 5);
    gx_body *body = body_of(&w);
    slots scope = {{3, 9, 10}, 3};
    gx_surface surfaces[2];
    gx_failure failure;
    uint64_t state, topology;
    add_axis_plane(&w, 0, 0.5);
    add_axis_plane(&w, 1, 0.5);
    surfaces[0] = surface_of(&w.surfaces[0]);
    surfaces[1] = surface_in(&w.surfaces[1], &scope);
    state = gx_body_state_hash(body);
    topology = hash_of(body);
    ck_assert_int_eq(cut_surfaces(body, surfaces, 2, &failure), GX_ERROR_INDEX);
    ck_assert_str_eq(failure.field, "surfaces.scope_slots");
    ck_assert(failure.result == GX_ERROR_INDEX && failure.surface == 1 && failure.index == 2);
    surfaces[1].scope_slots = NULL;
    ck_assert_int_eq(cut_surfaces(body, surfaces, 2, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "surfaces.scope_slots");
    ck_assert(failure.result == GX_ERROR_ARGUMENT && failure.surface == 1 && failure.index == SIZE_MAX);
    ck_assert(gx_body_state_hash(body) == state);
    scope.count = 0; /* a list without slots is a scope without cells */
    surfaces[1] = surface_in(&w.surfaces[1], &scope);
    ck_assert_int_eq(cut_surfaces(body, surfaces + 1, 1, &failure), GX_OK);
    ck_assert(hash_of(body) == topology);
    surfaces[1].kind = GX_SURFACE_SOLID; /* open: refused whatever it cuts */
    state = gx_body_state_hash(body);
    ck_assert_int_eq(cut_surfaces(body, surfaces + 1, 1, &failure), GX_ERROR_NOT_CLOSED);
    ck_assert(gx_body_state_hash(body) == state);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Cuts by slots list no cells and number no fragments. The stamps tell which cells they have met. */
START_TEST(cost_is_that_of_the_slots) {
    workload w = grid(8, 8, 8, 6);
    gx_body *body = body_of(&w);
    slots scope;
    gx_surface surfaces[2];
    gx_view view = view_of(body);
    const size_t listed = view.cell_count;
    uint32_t stamp, i;
    size_t met = 0;
    add_axis_plane(&w, 0, 0.5);
    add_box(&w, 1, 3.25, 3.25, -1, 3.75, 3.75, 9);
    for (i = 0, scope.count = 12; i < 12; i++) scope.slot[i] = i;
    surfaces[0] = surface_in(&w.surfaces[0], &scope);
    surfaces[1] = surface_in(&w.surfaces[1], &scope);
    ck_assert_int_eq(cut_surfaces(body, surfaces, 1, NULL), GX_OK);
    ck_assert(body->view.stale && body->cells.count > listed);
    stamp = body->scratch.stamp;
    ck_assert_int_eq(cut_surfaces(body, surfaces, 2, NULL), GX_OK);
    ck_assert(body->view.stale);
    ck_assert_uint_eq(body->view.count, listed); /* as it was before the first of the two cuts */
    for (i = 0; i < body->cells.count; i++) met += body->cells.stamp[i] > stamp;
    ck_assert_uint_le(met, 2 * scope.count);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static Suite *suite(void) {
    Suite *s = suite_create("scope");
    TCase *tests = tcase_create("slots");
    tcase_set_timeout(tests, 300);
    ADD_SOME(tests, one_cut_or_several, 200);
    ADD_SOME(tests, own_scopes_beside_that_of_the_cut, 100);
    ADD_SOME(tests, solids_remove_in_their_scope_only, 150);
    tcase_add_test(tests, a_piece_that_the_surface_does_not_touch);
    ADD_SOME(tests, slots_after_many_cuts, 40);
    ADD_SOME(tests, slots_of_copies, 20);
    tcase_add_test(tests, epochs);
    tcase_add_test(tests, parents_that_cannot_be);
    tcase_add_test(tests, refused_slots);
    tcase_add_test(tests, cost_is_that_of_the_slots);
    suite_add_tcase(s, tests);
    return s;
}

int main(void) { return run_suite(suite()); }
