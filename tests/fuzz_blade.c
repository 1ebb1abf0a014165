/* fuzz_blade.c - blades, tools that carve and cuts in bodies that are moved meanwhile, on cases made from bytes
   (fuzz_blade_cases.h). What is done and what is given may be senseless. Each call is checked for properties that hold
   for any input.

       fuzz_blade FILE... | --seed=S --cases=N --seconds=T --out=FOLDER     as fuzz.h says
                  --trace                                                   prints each call

   With -DGXFEM_LINKED it does not contain the library. A case is a body and a list of calls. Two bodies are given the
   same calls. The memory of one of them runs out now and then, and it is saved and loaded, cloned, and taken back. The
   other one has a host's threads.

   Checks:
       results       a call succeeds, or is refused with the code, the field and the index that the documentation
                     gives; then the state hash is as it was
       memory        a call whose memory runs out leaves the state hash as it was; made again, it does what it does to
                     the other body. No block is lost, none is released with another size or written beyond its end
       sameness      both bodies have the same reports, topology and state, to the last bit
       view          cells by element; copies of their nodes, used, in one fragment each; slots that are new, with older
                     parents; fragments are sums of their cells
       volume        sheets and blades take nothing away; solids and tools as much as they say; within 1e-12
       skin          closed, around each fragment */
#define _XOPEN_SOURCE 700
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#define FUZZ_BYTES 256
#ifndef FUZZ_SECONDS
#define FUZZ_SECONDS 60
#endif
#define FUZZ_FOLDER "build/fuzz_blade"
#include "fuzz.h"
#include "fuzz_blade_cases.h"
#include "scarce.h"
#include "skin_check.h"

enum { POINTS = 6, BLADES = 4, NUMBERS = 40, CALLS = 64 };

static struct {
    uint64_t moves, cuts, refused, failed, carved, saved, restored, steps;
    uint64_t most_fragments;
    double slowest; /* s, of a case */
    uint64_t slowest_seed;
} count;

/* ---- what a case is about ---- */

typedef struct stroke { /* of a blade */
    double edge[POINTS][3], way[3];
    size_t count;
    int begun, starts_inside;
} stroke;

static memory own, twins; /* of the body, and of the other one */

static struct {
    case_mesh mesh;
    gx_body *body, *twin, *mark, *twin_mark; /* marks: clones to go back to, or NULL */
    gx_view view;                            /* of body */
    stroke strokes[BLADES], marked[BLADES];
    uint32_t blades, marked_blades;
    size_t last_slots;
    double volume, first_volume, marked_volume;
    uint64_t marked_hash;
    unsigned char *bytes; /* of a saved body */
    size_t room;
} w;

static int traces;

static void trace(const char *format, ...) {
    va_list list;
    if (!traces) return;
    va_start(list, format);
    vfprintf(stderr, format, list);
    va_end(list);
}

static uint32_t blades_of(const gx_body *body) {
    uint32_t n = 0;
    while (gx_body_blade(body, n)) n++;
    return n;
}

/* ---- calls: one for each of two bodies ---- */

enum { MOVE, LIFT, CREATE, CUT, CARVE, LOCATE, STEP };
enum { CORNERS = 24, FACES = 12 };

typedef struct call {
    int kind;
    uint32_t blade;
    double x[CORNERS][3]; /* an edge, the corners of surfaces, places */
    size_t count;
    uint32_t triangles[FACES][3], scope[4];
    size_t triangle_count, scope_count;
    uint32_t solid, by_cells; /* of a cut: what it is, what scope names: 0 fragments, 1 cells, 2 slots */
    double sever_below;
    gx_blade_desc desc;
    gx_step_desc step;
} call;

typedef struct outcome {
    gx_result result;
    gx_failure failure;
    double number[NUMBERS]; /* all that a report says */
    uint32_t numbers;
} outcome;

static void add_number(outcome *o, double x) {
    if (o->numbers < NUMBERS) o->number[o->numbers++] = x;
}

static void add_cut(outcome *o, const gx_cut_report *r) {
    add_number(o, (double)r->touched_elements);
    add_number(o, (double)r->created_cells);
    add_number(o, (double)r->removed_cells);
    add_number(o, (double)r->created_copies);
    add_number(o, (double)r->removed_copies);
    add_number(o, (double)r->ignored_triangles);
    add_number(o, (double)r->severed_links);
    add_number(o, r->min_link_ratio);
    add_number(o, r->removed_volume);
}

static void add_blade(outcome *o, const gx_blade_report *r) {
    add_cut(o, &r->cut);
    add_number(o, (double)r->layer_count);
    add_number(o, (double)r->triangle_count);
    add_number(o, r->deviation);
}

static gx_surface surface_of(const call *c) {
    gx_surface s;
    memset(&s, 0, sizeof s);
    s.vertices = c->x[0];
    s.vertex_count = c->count;
    s.triangles = c->triangles[0];
    s.triangle_count = c->triangle_count;
    s.kind = c->solid;
    if (c->scope_count > 0 && c->by_cells == 2) {
        s.scope_slots = c->scope;
        s.scope_slot_count = c->scope_count;
    }
    return s;
}

static gx_result cut_as(gx_body *body, const call *c, outcome *o) {
    const gx_surface s = surface_of(c);
    gx_cut_desc desc;
    gx_cut_report report;
    gx_result result;
    memset(&desc, 0, sizeof desc);
    memset(&report, 0, sizeof report);
    desc.surfaces = &s;
    desc.surface_count = 1;
    desc.sever_below = c->sever_below;
    if (c->by_cells == 0) desc.scope_fragments = c->scope, desc.scope_fragment_count = c->scope_count;
    if (c->by_cells == 1) desc.scope_cells = c->scope, desc.scope_cell_count = c->scope_count;
    result = c->kind == CARVE ? gx_body_carve(body, &s, &report, &o->failure)
                              : gx_body_cut(body, &desc, &report, &o->failure);
    add_cut(o, &report);
    return result;
}

static gx_result locate_as(gx_body *body, const call *c, outcome *o) {
    gx_hit hits[4];
    size_t i, k;
    const gx_result result = gx_body_locate(body, c->x[0], c->count, hits, &o->failure);
    for (i = 0; i < c->count && result == GX_OK; i++) {
        add_number(o, hits[i].slot);
        add_number(o, hits[i].distance);
        for (k = 0; k < 3; k++) add_number(o, hits[i].material[k]);
    }
    return result;
}

static void make(gx_body *body, const call *c, outcome *o) {
    gx_blade *blade = gx_body_blade(body, c->blade);
    gx_blade_report report;
    gx_step_report step;
    memset(o, 0, sizeof *o);
    memset(&report, 0, sizeof report);
    memset(&step, 0, sizeof step);
    switch (c->kind) {
    case MOVE:
        o->result = gx_blade_move(blade, c->x[0], c->count, c->scope, c->scope_count, &report, &o->failure);
        add_blade(o, &report);
        break;
    case LIFT:
        o->result = gx_blade_lift(blade, &report, &o->failure);
        add_blade(o, &report);
        break;
    case CREATE: o->result = gx_blade_create(body, &c->desc, &blade, &o->failure); break;
    case LOCATE: o->result = locate_as(body, c, o); break;
    case STEP: o->result = gx_body_step(body, &c->step, &step, &o->failure); break;
    default: o->result = cut_as(body, c, o); break;
    }
    REQUIRE(o->result == o->failure.result, "call %d: %d, but its failure says %d", c->kind, (int)o->result,
            (int)o->failure.result);
}

static void check_same_bodies(const char *what) {
    gx_failure failure;
    uint64_t a, b;
    REQUIRE(gx_body_state_hash(w.body) == gx_body_state_hash(w.twin), "%s: another state", what);
    a = gx_body_topology_hash(w.body, &failure);
    REQUIRE(failure.result == GX_OK, "%s: topology hash", what);
    b = gx_body_topology_hash(w.twin, NULL);
    REQUIRE(a == b, "%s: another topology", what);
}

static const char *const names[] = {"move", "lift", "create", "cut", "carve", "locate", "step"};

static void trace_call(const call *c, uint32_t fail_code) {
    size_t i;
    trace("%s%s", names[c->kind], fail_code > 0 ? ", out of memory before" : "");
    if (c->kind == MOVE || c->kind == LIFT) trace(", blade %u", (unsigned)c->blade);
    if (c->kind == CREATE)
        trace(", tolerance %g, advance %g, %u samples, inside %d", c->desc.tolerance, c->desc.min_advance,
              (unsigned)c->desc.max_samples, c->desc.starts_inside);
    for (i = 0; i < c->scope_count; i++) trace(", scope %u", (unsigned)c->scope[i]);
    trace("\n");
    for (i = 0; i < c->count; i++) trace("    %.17g, %.17g, %.17g,\n", c->x[i][0], c->x[i][1], c->x[i][2]);
}

static const char *field_of(const outcome *o) { return o->failure.field ? o->failure.field : ""; }

/* Makes a call for both bodies. In the first its memory may run out before. fail: 0: it does not, else from which
   allocation on, and how */
static outcome perform(const call *c, uint32_t fail_code) {
    const uint64_t before = gx_body_state_hash(w.body);
    outcome o, t;
    trace_call(c, fail_code);
    memset(&o, 0, sizeof o);
    o.result = GX_ERROR_MEMORY;
    if (fail_code > 0) {
        fail_from(&own, fail_code / 2 < 8 ? fail_code / 2 : fail_code * fail_code / 64, fail_code % 2);
        make(w.body, c, &o);
        count.failed += o.result == GX_ERROR_MEMORY;
        REQUIRE(own.failed || o.result != GX_ERROR_MEMORY, "%s: out of memory without need", names[c->kind]);
        never_fail(&own);
        REQUIRE(o.result == GX_OK || gx_body_state_hash(w.body) == before, "%s: an error (%d) leaves traces",
                names[c->kind], (int)o.result);
    }
    if (o.result != GX_OK) make(w.body, c, &o);
    make(w.twin, c, &t);
    trace("    gives %d, %zu touched elements\n", (int)t.result, (size_t)t.number[0]);
    REQUIRE(o.result == t.result, "%s: results %d and %d", names[c->kind], (int)o.result, (int)t.result);
    REQUIRE(strcmp(field_of(&o), field_of(&t)) == 0 && o.failure.index == t.failure.index,
            "%s: failures %s %zu and %s %zu", names[c->kind], field_of(&o), o.failure.index, field_of(&t),
            t.failure.index);
    REQUIRE(memcmp(o.number, t.number, sizeof o.number) == 0, "%s: reports differ", names[c->kind]);
    if (o.result != GX_OK) {
        REQUIRE(gx_body_state_hash(w.body) == before, "%s: an error (%d) leaves traces", names[c->kind], (int)o.result);
        count.refused++;
    }
    check_same_bodies(names[c->kind]);
    return o;
}

/* ---- the view ---- */

static void check_cells(const gx_view *v) {
    static uint8_t slot_used[1 << 16], copy_used[1 << 16];
    static uint32_t fragment_of[1 << 16];
    size_t i, k;
    if (v->slot_count > sizeof slot_used || v->copy_count > sizeof copy_used) return;
    memset(slot_used, 0, v->slot_count);
    memset(copy_used, 0, v->copy_count);
    for (i = 0; i < v->slot_count; i++)
        REQUIRE(i < v->element_count ? v->slot_parent[i] == i : v->slot_parent[i] < i, "slot %zu: its parent", i);
    for (i = 0; i < v->cell_count; i++) {
        const uint32_t e = v->cell_element[i], f = v->cell_fragment[i], slot = v->cell_slot[i];
        REQUIRE(e < v->element_count && (i == 0 || v->cell_element[i - 1] <= e), "cell %zu: its element", i);
        REQUIRE(f < v->fragment_count, "cell %zu: its fragment", i);
        REQUIRE(slot < v->slot_count && !slot_used[slot], "cell %zu: its slot", i);
        REQUIRE(v->cell_volume[i] >= 0, "cell %zu has volume %g", i, v->cell_volume[i]);
        slot_used[slot] = 1;
        for (k = 0; k < 4; k++) {
            const uint32_t c = v->cell_copies[4 * i + k];
            REQUIRE(c < v->copy_count && v->copy_node[c] == w.mesh.t[e][k], "cell %zu: its copy %zu", i, k);
            if (copy_used[c])
                REQUIRE(fragment_of[c] == f, "copy %u is in two fragments", (unsigned)c);
            else
                fragment_of[c] = f;
            copy_used[c] = 1;
        }
    }
    for (i = 0; i < v->copy_count; i++) REQUIRE(copy_used[i], "copy %zu moves nothing", i);
}

static void check_fragments(const gx_view *v) {
    double *sum = (double *)calloc(v->fragment_count + 1, sizeof *sum), all = 0;
    size_t i, j;
    int right = 1, ids = 1;
    for (i = 0; i < v->cell_count; i++) sum[v->cell_fragment[i]] += v->cell_volume[i];
    for (i = 0; i < v->fragment_count; i++) {
        right = right && fabs(sum[i] - v->fragment_volume[i]) <= 1e-12 * w.first_volume;
        all += v->fragment_volume[i];
        for (j = 0; j < i && v->fragment_count < 100; j++) ids = ids && v->fragment_id[i] != v->fragment_id[j];
    }
    free(sum);
    REQUIRE(right && fabs(all - v->volume) <= 1e-12 * w.first_volume, "fragments are not sums of their cells");
    REQUIRE(ids, "two fragments have one id");
}

static void look(void) {
    gx_view t;
    REQUIRE(gx_body_view(w.body, &w.view, NULL) == GX_OK && gx_body_view(w.twin, &t, NULL) == GX_OK, "view");
    check_cells(&w.view);
    check_fragments(&w.view);
    REQUIRE(w.view.slot_count >= w.last_slots, "slots were lost");
    w.last_slots = w.view.slot_count;
    REQUIRE(fabs(w.view.volume - w.volume) <= 1e-12 * w.first_volume, "volume %.17g, should be %.17g", w.view.volume,
            w.volume);
    if (w.view.fragment_count > count.most_fragments) count.most_fragments = w.view.fragment_count;
}

static void check_skin(void) {
    gx_skin skin;
    gx_failure failure;
    double *x;
    uint32_t f;
    int closed = 1;
    gx_result result = gx_body_skin(w.body, NULL, &skin, &failure);
    REQUIRE(result == GX_OK, "skin: %d", (int)result);
    x = (double *)malloc((3 * skin.vertex_count + 1) * sizeof *x);
    memcpy(x, skin.vertex_rest, 3 * skin.vertex_count * sizeof *x);
    for (f = 0; f < w.view.fragment_count && f < 20; f++) closed = closed && skin_count(&skin, f, x).open_edges == 0;
    free(x);
    REQUIRE(closed, "the skin is open");
}

/* ---- places in space ---- */

static const double *rest_of(size_t copy) { return w.mesh.x[w.view.copy_node[copy]]; }

static void copy_place(size_t copy, double x[3]) {
    int k;
    for (k = 0; k < 3; k++) x[k] = rest_of(copy)[k] + w.view.displacement[3 * copy + (size_t)k];
}

/* A mean of `corners` corners of a cell, from one of them on */
static void cell_place(uint32_t cell, uint32_t from, uint32_t corners, double x[3]) {
    double y[3];
    uint32_t i;
    int k;
    x[0] = x[1] = x[2] = 0;
    for (i = 0; i < corners; i++) {
        copy_place(w.view.cell_copies[4 * (size_t)cell + (from + i) % 4], y);
        for (k = 0; k < 3; k++) x[k] += y[k] / corners;
    }
}

/* Anywhere in the box of the body at rest, somewhat wider */
static void any_place(case_bytes *b, double x[3]) {
    int k;
    for (k = 0; k < 3; k++)
        x[k] = 0.5 * (w.mesh.low[k] + w.mesh.high[k]) +
               case_real(b) * (0.5 * (w.mesh.high[k] - w.mesh.low[k]) + 0.2 * w.mesh.cube);
}

/* A place in space, often one at which something meets */
static void take_place(case_bytes *b, double x[3]) {
    const uint32_t how = case_take(b), which = how / 8 * 7;
    int k;
    any_place(b, x);
    if (w.view.cell_count == 0) return;
    switch (how % 8) {
    case 0: copy_place(which % w.view.copy_count, x); break;
    case 1: cell_place(which % (uint32_t)w.view.cell_count, which, 2, x); break;
    case 2: cell_place(which % (uint32_t)w.view.cell_count, which, 3, x); break;
    case 3: cell_place(which % (uint32_t)w.view.cell_count, which, 4, x); break;
    case 4:
    case 5: /* on the lattice, or a quarter beside it */
        for (k = 0; k < 3; k++)
            x[k] = w.mesh.low[k] + floor((x[k] - w.mesh.low[k]) / w.mesh.cube * 4 + 0.5) / 4 * w.mesh.cube;
        break;
    default: break;
    }
}

/* The first copy that is too far away or nowhere, SIZE_MAX: none is */
static size_t wild_copy(gx_result *result) {
    size_t i, k;
    for (i = 0; i < w.view.copy_count; i++) {
        double x[3];
        int wild = 0, finite = 1;
        copy_place(i, x);
        for (k = 0; k < 3; k++) {
            wild |= !(fabs(x[k]) < ldexp(1, 128));
            finite &= isfinite(w.view.displacement[3 * i + k]) != 0;
        }
        *result = finite ? GX_ERROR_RANGE : GX_ERROR_NOT_FINITE;
        if (wild) return i;
    }
    *result = GX_OK;
    return SIZE_MAX;
}

/* ---- strokes ---- */

static double reach_of_body(void) {
    double square = 0;
    int k;
    for (k = 0; k < 3; k++) square += (w.mesh.high[k] - w.mesh.low[k]) * (w.mesh.high[k] - w.mesh.low[k]);
    return sqrt(square) + w.mesh.cube;
}

/* Points of an edge along a line, unevenly or not, some of them equal or back and forth */
static void spread_points(case_bytes *b, stroke *s, const double from[3], const double to[3]) {
    const uint32_t how = case_take(b);
    size_t i;
    int k;
    for (i = 0; i < s->count; i++) {
        double share = (double)i / (double)(s->count - 1);
        if (how % 4 == 1) share = floor(share * 2) / 2;
        if (how % 4 == 2) share = 0.5 + 0.5 * case_noise(how, i, 3);
        if (how % 4 == 3) share *= share;
        for (k = 0; k < 3; k++) s->edge[i][k] = share < 1 ? from[k] + share * (to[k] - from[k]) : to[k];
    }
}

/* A straight edge through two places, and beyond them */
static void straight_edge(case_bytes *b, stroke *s, double beyond) {
    double from[3], to[3], d[3], length = 0;
    int k;
    take_place(b, from);
    take_place(b, to);
    for (k = 0; k < 3; k++) d[k] = to[k] - from[k];
    if (case_take(b) % 3 == 0) /* along an axis */
        for (k = 0; k < 3; k++) d[k] = k == (int)(s->count % 3) ? w.mesh.cube : 0;
    for (k = 0; k < 3; k++) length += d[k] * d[k];
    length = sqrt(length);
    if (length > 0)
        for (k = 0; k < 3; k++) {
            from[k] -= beyond / length * d[k];
            to[k] += beyond / length * d[k];
        }
    spread_points(b, s, from, to);
}

static void bent_edge(case_bytes *b, stroke *s) {
    size_t i;
    for (i = 0; i < s->count; i++) take_place(b, s->edge[i]);
}

static void take_edge(case_bytes *b, stroke *s) {
    const uint32_t kind = case_take(b) % 16;
    const double h = w.mesh.cube;
    size_t i;
    switch (kind) {
    case 0: bent_edge(b, s); break;
    case 1: /* closed */
        bent_edge(b, s);
        memcpy(s->edge[s->count - 1], s->edge[0], sizeof s->edge[0]);
        break;
    case 2: /* one point */
        take_place(b, s->edge[0]);
        for (i = 1; i < s->count; i++) memcpy(s->edge[i], s->edge[0], sizeof s->edge[0]);
        break;
    case 3: straight_edge(b, s, 0); break;
    case 4: straight_edge(b, s, 1e-9 * h); break;
    case 5: straight_edge(b, s, (case_take(b) % 2 ? 1e30 : 1e12) * h); break;
    case 6: straight_edge(b, s, -0.3 * h); break;
    default: straight_edge(b, s, 2 * reach_of_body()); break;
    }
}

/* A new edge, and the way that it is moved; most begin outside of the body. */
static void begin_stroke(case_bytes *b, stroke *s) {
    static const double steps[8] = {0.4, 0.4, 0.8, 0.2, 2, 8, 1e-3, 0.4};
    const uint32_t how = case_take(b);
    const double step = steps[how % 8] * w.mesh.cube;
    double back = reach_of_body();
    size_t i;
    int k;
    s->count = 2 + (how / 8 % 4 == 0 ? case_take(b) % (POINTS - 1) : 0);
    take_edge(b, s);
    for (k = 0; k < 3; k++) s->way[k] = step * case_real(b);
    if (how / 32 % 4 == 0)
        for (k = 0; k < 3; k++) s->way[k] = k == (int)(how / 64 + s->count) % 3 ? step : 0;
    back = back / step < 30 ? floor(back / step) : 30;
    if (how >= 32 || s->starts_inside == 0)
        for (i = 0; i < s->count; i++)
            for (k = 0; k < 3; k++) s->edge[i][k] -= 0.7 * back * s->way[k];
}

static void shift_edge(stroke *s, double times) {
    size_t i;
    int k;
    for (i = 0; i < s->count; i++)
        for (k = 0; k < 3; k++) s->edge[i][k] += times * s->way[k];
}

/* The next place of an edge */
static void advance_stroke(case_bytes *b, stroke *s) {
    const uint32_t how = case_take(b), kind = how % 24;
    double along[3];
    size_t i;
    int k;
    for (k = 0; k < 3; k++) along[k] = s->edge[s->count - 1][k] - s->edge[0][k];
    switch (kind) {
    case 0: break; /* stays */
    case 1: shift_edge(s, -1); break;
    case 2: shift_edge(s, -4); break;
    case 3: shift_edge(s, 5); break;
    case 4: shift_edge(s, 30); break;
    case 5: shift_edge(s, 1e-6); break;
    case 6: take_edge(b, s); break;
    case 7:
        for (i = 0; i < s->count; i++) {
            for (k = 0; k < 3; k++) along[k] = s->edge[0][k];
            case_turn(s->edge[i], along, how, 0.3 * case_noise(how, 1, 1));
        }
        break;
    case 8:
        for (i = 0; i < s->count; i++)
            for (k = 0; k < 3; k++) s->edge[i][k] += 0.1 * along[k];
        break;
    case 9:
        for (i = 0; i < s->count; i++)
            for (k = 0; k < 3; k++) s->edge[i][k] += 0.2 * w.mesh.cube * case_noise(how, i, (uint32_t)k);
        break;
    case 10: /* onto the lattice */
        for (i = 0; i < s->count; i++)
            for (k = 0; k < 3; k++)
                s->edge[i][k] =
                    w.mesh.low[k] + floor((s->edge[i][k] - w.mesh.low[k]) / w.mesh.cube + 0.5) * w.mesh.cube;
        break;
    case 11: /* out of range, now and then */
        if (how / 24 % 4 == 0) s->edge[how % s->count][how % 3] = case_wild(how);
        break;
    case 12: /* other ways */
        for (k = 0; k < 3; k++) s->way[k] = 0.5 * w.mesh.cube * case_real(b);
        shift_edge(s, 1);
        break;
    case 13:
        if (how / 24 % 4 == 0) s->edge[0][how % 3] += 1e30;
        break;
    default: shift_edge(s, 1); break;
    }
}

/* ---- moves ---- */

/* copy: the first that is wild, and what it is refused with, before the move */
static void check_refused_edge(const call *c, const outcome *o, const stroke *s, size_t copy, gx_result wild) {
    size_t i;
    for (i = 0; i < 3 * c->count; i++) {
        const double x = c->x[i / 3][i % 3];
        const gx_result bad = !isfinite(x) ? GX_ERROR_NOT_FINITE : fabs(x) > ldexp(1, 110) ? GX_ERROR_RANGE : GX_OK;
        if (bad == GX_OK) continue;
        REQUIRE(o->result == bad && strcmp(field_of(o), "edge") == 0 && o->failure.index == i / 3,
                "move: %d, field %s, index %zu, should be %d for point %zu", (int)o->result, field_of(o),
                o->failure.index, (int)bad, i / 3);
        return;
    }
    if (c->scope_count > 0 && c->scope[0] >= w.view.fragment_count) {
        REQUIRE(o->result == GX_ERROR_INDEX && strcmp(field_of(o), "scope_fragments") == 0, "move: %d, field %s",
                (int)o->result, field_of(o));
        return;
    }
    if (wild != GX_OK) {
        REQUIRE(o->result == wild && strcmp(field_of(o), "displacement") == 0 && o->failure.index == copy,
                "move: %d, field %s, index %zu, should be %d for copy %zu", (int)o->result, field_of(o),
                o->failure.index, (int)wild, copy);
        return;
    }
    if (o->result == GX_ERROR_ARGUMENT && !s->begun && !s->starts_inside) {
        REQUIRE(strcmp(field_of(o), "starts_inside") == 0 && o->failure.index < c->count, "move: field %s, index %zu",
                field_of(o), o->failure.index);
        return;
    }
    REQUIRE(o->result == GX_OK, "move: %d, field %s, index %zu", (int)o->result, field_of(o), o->failure.index);
}

/* What the report of a move or lift says */
static void check_report(const outcome *o) {
    const double touched = o->number[0], link = o->number[7], removed = o->number[8], triangles = o->number[10],
                 deviation = o->number[11];
    REQUIRE(link > 0 && link <= 1, "link ratio %g", link);
    REQUIRE(!(removed > 0) && !(removed < 0), "a blade removed %g", removed);
    REQUIRE(deviation >= 0 && deviation < HUGE_VAL, "deviation %g", deviation);
    REQUIRE(triangles > 0 || (!(touched > 0) && link >= 1), "no triangle, but %g touched elements", touched);
    count.cuts += touched > 0;
}

static void move_blade(case_bytes *b, uint32_t which, uint32_t fail_code) {
    const uint32_t blade = which % w.blades, how = case_take(b);
    stroke *s = &w.strokes[blade], before;
    gx_result wild;
    const size_t copy = wild_copy(&wild);
    call c;
    outcome o;
    memset(&c, 0, sizeof c);
    before = *s;
    if (!s->begun || how % 64 == 63)
        begin_stroke(b, s);
    else
        advance_stroke(b, s);
    if (s->begun) s->count = before.count;
    c.kind = MOVE;
    c.blade = blade;
    c.count = s->count;
    memcpy(c.x, s->edge, sizeof s->edge);
    if (how / 64 == 0 && w.view.fragment_count > 0) c.scope[c.scope_count++] = how % (uint32_t)w.view.fragment_count;
    if (how == 5) c.scope[0] = 9999, c.scope_count = 1;
    o = perform(&c, fail_code);
    count.moves++;
    check_refused_edge(&c, &o, s, copy, wild);
    if (o.result == GX_OK) {
        s->begun = 1;
        check_report(&o);
    } else if (before.begun)
        *s = before;
}

static void lift_blade(uint32_t which, uint32_t fail_code) {
    stroke *s = &w.strokes[which % w.blades];
    gx_result wild;
    call c;
    outcome o;
    memset(&c, 0, sizeof c);
    c.kind = LIFT;
    c.blade = which % w.blades;
    wild_copy(&wild);
    o = perform(&c, fail_code);
    if (!s->begun) wild = GX_OK;
    REQUIRE(o.result == wild, "lift: %d, field %s, index %zu, should be %d", (int)o.result, field_of(&o),
            o.failure.index, (int)wild);
    if (o.result != GX_OK) return;
    s->begun = 0;
    check_report(&o);
}

static void create_blade(case_bytes *b, uint32_t fail_code) {
    static const double tolerances[8] = {0, 0, 0, 1e-9, 1e-300, 0.3, 1e30, 0.001},
                        advances[8] = {0, 0, 0, 1e-12, 1, 1e30, 1e-300, 0.1};
    static const uint32_t samples[8] = {0, 0, 0, 1, 2, 3, 10, 40};
    const uint32_t how = case_take(b), more = case_take(b);
    call c;
    outcome o;
    if (w.blades == BLADES) return;
    memset(&c, 0, sizeof c);
    c.kind = CREATE;
    c.desc.tolerance = tolerances[how % 8] * w.mesh.cube;
    c.desc.min_advance = advances[how / 8 % 8] * w.mesh.cube;
    c.desc.max_samples = samples[more % 8];
    c.desc.starts_inside = more / 8 % 2;
    o = perform(&c, fail_code);
    REQUIRE(o.result == GX_OK, "create: %d, field %s", (int)o.result, field_of(&o));
    memset(&w.strokes[w.blades], 0, sizeof w.strokes[w.blades]);
    w.strokes[w.blades++].starts_inside = c.desc.starts_inside;
}

static void destroy_blade(uint32_t which) {
    uint32_t i = which % w.blades;
    if (w.blades < 2) return;
    gx_blade_destroy(gx_body_blade(w.body, i));
    gx_blade_destroy(gx_body_blade(w.twin, i));
    for (w.blades--; i < w.blades; i++) w.strokes[i] = w.strokes[i + 1];
    check_same_bodies("destroy");
}

/* ---- poses ---- */

/* Displaces both bodies alike. */
static void pose(case_bytes *b) {
    const case_pose p = case_make_pose(b);
    gx_view twin;
    uint32_t *fragment = (uint32_t *)calloc(w.view.copy_count + 1, sizeof *fragment);
    size_t i;
    trace("pose %u, seed %u, strength %g, way %g %g %g\n", (unsigned)p.kind % 16, (unsigned)p.seed, p.strength,
          p.way[0], p.way[1], p.way[2]);
    gx_body_view(w.twin, &twin, NULL);
    for (i = 0; i < 4 * w.view.cell_count; i++) fragment[w.view.cell_copies[i]] = w.view.cell_fragment[i / 4];
    for (i = 0; i < w.view.copy_count; i++) {
        double *u = w.view.displacement + 3 * i;
        case_displace(&w.mesh, &p, rest_of(i), i, fragment[i], w.view.fragment_center + 3 * (size_t)fragment[i], u);
        memcpy(twin.displacement + 3 * i, u, 3 * sizeof *u);
    }
    free(fragment);
}

/* ---- cuts and tools ---- */

static void add_triangle(call *c, uint32_t i, uint32_t j, uint32_t k) {
    uint32_t *t = c->triangles[c->triangle_count++];
    t[0] = i;
    t[1] = j;
    t[2] = k;
}

static void add_box(call *c, const double low[3], const double high[3]) {
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    uint32_t i, k;
    for (i = 0; i < 8; i++)
        for (k = 0; k < 3; k++) c->x[i][k] = i >> k & 1 ? high[k] : low[k];
    c->count = 8;
    memcpy(c->triangles, faces, sizeof faces);
    c->triangle_count = 12;
}

/* A closed box, or a tetrahedron */
static void take_solid(case_bytes *b, call *c) {
    static const double sizes[8] = {0.6, 0.3, 1, 0.01, 2, 100, 0.5, 0.8};
    const uint32_t how = case_take(b);
    double x[3], low[3], high[3];
    uint32_t i;
    int k;
    take_place(b, x);
    c->solid = GX_SURFACE_SOLID;
    if (how / 8 % 4 == 3) {
        for (i = 0; i < 4; i++) take_place(b, c->x[i]);
        c->count = 4;
        add_triangle(c, 1, 2, 3);
        add_triangle(c, 0, 3, 2);
        add_triangle(c, 0, 1, 3);
        add_triangle(c, 0, 2, 1);
        return;
    }
    for (k = 0; k < 3; k++) {
        const double half = w.mesh.cube * sizes[how % 8] * (how & 128 ? 1 : 0.5 + 0.5 * fabs(case_real(b)));
        low[k] = x[k] - half;
        high[k] = x[k] + half;
    }
    add_box(c, low, high);
    if (how / 8 % 4 == 2)
        for (i = 0; i < 8; i++) case_turn(c->x[i], x, how, how);
}

/* A plane across the body or a few triangles */
static void take_sheet(case_bytes *b, call *c) {
    const uint32_t how = case_take(b), axis = how / 4 % 3;
    uint32_t i;
    double x[3];
    int k;
    if (how % 4 < 2) {
        take_place(b, x);
        for (i = 0; i < 4; i++) {
            c->x[i][axis] = x[axis];
            for (k = 1; k < 3; k++)
                c->x[i][(axis + (uint32_t)k) % 3] =
                    x[(axis + (uint32_t)k) % 3] + 3 * reach_of_body() * ((i + (uint32_t)k) / 2 % 2 ? 1 : -1);
            if (how % 4 == 1) case_turn(c->x[i], x, axis + 1, 0.01 * how);
        }
        c->count = 4;
        add_triangle(c, 0, 1, 2);
        add_triangle(c, 0, 2, 3);
        return;
    }
    c->count = 3 + how / 16 % 4;
    for (i = 0; i < c->count; i++) take_place(b, c->x[i]);
    for (i = 2; i < c->count; i++) add_triangle(c, 0, i - 1, i);
}

static void take_scope(case_bytes *b, call *c) {
    const uint32_t how = case_take(b);
    size_t limit;
    c->by_cells = how / 4 % 3;
    limit = c->by_cells == 0 ? w.view.fragment_count : c->by_cells == 1 ? w.view.cell_count : w.view.slot_count;
    if (how % 4 != 0 || limit == 0) return;
    while (c->scope_count < 1 + how / 16 % 4) c->scope[c->scope_count++] = case_take(b) * 5 % (uint32_t)limit;
}

/* Is it far from what is allowed? Coordinates of cuts are at most 2^127. */
static int is_in_range(const call *c) {
    size_t i;
    for (i = 0; i < 3 * c->count; i++)
        if (!(fabs(c->x[i / 3][i % 3]) < 1e30)) return 0;
    return 1;
}

static void cut(case_bytes *b, int solid, uint32_t fail_code) {
    call c;
    outcome o;
    memset(&c, 0, sizeof c);
    c.kind = CUT;
    if (solid)
        take_solid(b, &c);
    else
        take_sheet(b, &c);
    take_scope(b, &c);
    if (c.by_cells == 0 && c.solid == 0 && case_take(b) % 8 == 0) c.sever_below = 0.05;
    if (!is_in_range(&c)) return;
    o = perform(&c, fail_code);
    REQUIRE(o.result == GX_OK, "cut: %d, field %s, index %zu", (int)o.result, field_of(&o), o.failure.index);
    REQUIRE(o.number[8] >= 0 && (solid || !(o.number[8] > 0)), "a cut removed %g", o.number[8]);
    w.volume -= o.number[8];
}

static void carve(case_bytes *b, uint32_t fail_code) {
    gx_result wild;
    uint32_t open;
    call c;
    outcome o;
    memset(&c, 0, sizeof c);
    take_solid(b, &c);
    c.kind = CARVE;
    open = case_take(b) % 16 == 0;
    c.triangle_count -= open;
    /* a tool is divided as finely as elements are thick: in flat ones that takes minutes */
    if (!is_in_range(&c) || w.mesh.is_flat) return;
    wild_copy(&wild);
    o = perform(&c, fail_code);
    REQUIRE(o.result == wild || (open && o.result == GX_ERROR_NOT_CLOSED), "carve: %d, field %s, index %zu",
            (int)o.result, field_of(&o), o.failure.index);
    if (o.result != GX_OK) return;
    REQUIRE(o.number[8] >= 0, "a tool removed %g", o.number[8]);
    w.volume -= o.number[8];
    count.carved += o.number[8] > 0;
}

/* ---- saving, clones, going back ---- */

static size_t save(gx_body *body) {
    size_t size;
    REQUIRE(gx_body_save(body, NULL, 0, &size, NULL) == GX_OK, "save");
    if (size > w.room) {
        free(w.bytes);
        w.bytes = (unsigned char *)malloc(w.room = 2 * size);
    }
    REQUIRE(gx_body_save(body, w.bytes, w.room, &size, NULL) == GX_OK, "save");
    return size;
}

/* The first body becomes one that is loaded, or a clone. */
static void replace(uint32_t how, uint32_t fail_code) {
    const uint64_t before = gx_body_state_hash(w.body);
    const size_t size = how % 2 ? save(w.body) : 0;
    gx_body_desc desc;
    gx_body *made = NULL;
    gx_result result = GX_ERROR_MEMORY;
    int tries;
    trace("%s\n", how % 2 ? "save and load" : "clone");
    memset(&desc, 0, sizeof desc);
    desc.allocator = allocator_of(&own);
    for (tries = fail_code > 0 ? 0 : 1; tries < 2 && result == GX_ERROR_MEMORY; tries++) {
        if (tries == 0) fail_from(&own, fail_code / 2, fail_code % 2);
        result = how % 2 ? gx_body_load(w.bytes, size, &desc, &made, NULL) : gx_body_clone(w.body, &made, NULL);
        count.failed += result == GX_ERROR_MEMORY;
        never_fail(&own);
        REQUIRE(gx_body_state_hash(w.body) == before, "saving or cloning: the body has changed");
    }
    REQUIRE(result == GX_OK, "%s: %d", how % 2 ? "load" : "clone", (int)result);
    gx_body_destroy(w.body);
    w.body = made;
    count.saved++;
    REQUIRE(gx_body_state_hash(w.body) == before, "%s: another state", how % 2 ? "load" : "clone");
    check_same_bodies(how % 2 ? "load" : "clone");
}

static void set_mark(void) {
    trace("mark\n");
    gx_body_destroy(w.mark);
    gx_body_destroy(w.twin_mark);
    w.mark = w.twin_mark = NULL;
    REQUIRE(gx_body_clone(w.body, &w.mark, NULL) == GX_OK && gx_body_clone(w.twin, &w.twin_mark, NULL) == GX_OK,
            "clone");
    memcpy(w.marked, w.strokes, sizeof w.marked);
    w.marked_blades = w.blades;
    w.marked_volume = w.volume;
    w.marked_hash = gx_body_state_hash(w.body);
}

/* Both bodies become what they were at the mark. Blades made since stay, and are lifted. */
static void go_back(uint32_t fail_code) {
    const uint64_t before = gx_body_state_hash(w.body);
    gx_result result = GX_ERROR_MEMORY;
    uint32_t i;
    if (w.mark == NULL) return;
    trace("back to the mark\n");
    if (fail_code > 0) {
        fail_from(&own, fail_code / 2, fail_code % 2);
        result = gx_body_restore(w.body, w.mark, NULL);
        never_fail(&own);
        count.failed += result == GX_ERROR_MEMORY;
        REQUIRE(result == GX_OK || gx_body_state_hash(w.body) == before, "restore: an error leaves traces");
    }
    if (result != GX_OK) result = gx_body_restore(w.body, w.mark, NULL);
    REQUIRE(result == GX_OK && gx_body_restore(w.twin, w.twin_mark, NULL) == GX_OK, "restore: %d", (int)result);
    REQUIRE(gx_body_state_hash(w.mark) == w.marked_hash, "restore: the clone has changed");
    for (i = 0; i < w.marked_blades; i++) w.strokes[i] = w.marked[i];
    for (i = w.marked_blades; i < w.blades; i++) w.strokes[i].begun = 0;
    if (w.blades < w.marked_blades) w.blades = w.marked_blades;
    REQUIRE(blades_of(w.body) == w.blades && blades_of(w.twin) == w.blades, "restore: %u blades, should be %u",
            (unsigned)blades_of(w.body), (unsigned)w.blades);
    w.volume = w.marked_volume;
    w.last_slots = 0;
    count.restored++;
    if (w.blades == w.marked_blades) REQUIRE(gx_body_state_hash(w.body) == w.marked_hash, "restore: another state");
    check_same_bodies("restore");
}

/* ---- steps, places ---- */

/* Both bodies are saved before, so that their solvers start anew. */
static void step(case_bytes *b, uint32_t fail_code) {
    call c;
    outcome o;
    int k;
    memset(&c, 0, sizeof c);
    c.kind = STEP;
    c.step.dt = 0.01;
    c.step.cg_iterations = 30;
    for (k = 0; k < 3; k++) c.step.gravity[k] = 10 * case_real(b);
    save(w.body);
    save(w.twin);
    o = perform(&c, fail_code);
    REQUIRE(o.result == GX_OK || o.result == GX_ERROR_NOT_FINITE || o.result == GX_ERROR_RANGE ||
                o.result == GX_ERROR_FLAT || o.result == GX_ERROR_DIVERGED,
            "step: %d, field %s, index %zu", (int)o.result, field_of(&o), o.failure.index);
    count.steps += o.result == GX_OK;
}

static void locate(case_bytes *b, uint32_t fail_code) {
    gx_result wild, bad = GX_OK;
    size_t i;
    call c;
    outcome o;
    memset(&c, 0, sizeof c);
    c.kind = LOCATE;
    for (c.count = 0; c.count < 4; c.count++) take_place(b, c.x[c.count]);
    for (i = 0; i < 12 && bad == GX_OK; i++)
        bad = !isfinite(c.x[i / 3][i % 3])             ? GX_ERROR_NOT_FINITE
            : fabs(c.x[i / 3][i % 3]) >= ldexp(1, 128) ? GX_ERROR_RANGE
                                                       : GX_OK;
    wild_copy(&wild);
    if (bad != GX_OK) wild = bad;
    if (wild == GX_OK && w.view.cell_count == 0) wild = GX_ERROR_EMPTY;
    o = perform(&c, fail_code);
    REQUIRE(o.result == wild, "locate: %d, field %s, index %zu, should be %d", (int)o.result, field_of(&o),
            o.failure.index, (int)wild);
}

/* ---- cases ---- */

/* The host's threads of the twin: the last job comes first */
static void run_backwards(void *user, size_t count, void (*task)(void *context, size_t index), void *context) {
    (void)user;
    while (count > 0) task(context, --count);
}

static gx_body *create(memory *m) {
    gx_body_desc desc;
    gx_body *body = NULL;
    memset(&desc, 0, sizeof desc);
    desc.positions = w.mesh.x[0];
    desc.node_count = w.mesh.nodes;
    desc.elements = w.mesh.t[0];
    desc.element_count = w.mesh.elements;
    desc.young = 1e5;
    desc.poisson = 0.4;
    desc.density = 1000;
    desc.allocator = allocator_of(m);
    if (m == &twins) desc.jobs.parallel_for = run_backwards;
    return gx_body_create(&desc, &body, NULL) == GX_OK ? body : NULL;
}

static void act(case_bytes *b) {
    const uint32_t code = case_take(b), kind = code % 32, which = code / 32;
    const uint32_t fail_byte = case_take(b), fail_code = fail_byte % 8 == 0 ? fail_byte / 8 * 4 + code / 64 + 1 : 0;
    switch (kind) {
    case 0: lift_blade(which, fail_code); break;
    case 1: create_blade(b, fail_code); break;
    case 2: destroy_blade(which); break;
    case 3: cut(b, 0, fail_code); break;
    case 4: cut(b, 1, fail_code); break;
    case 5: carve(b, fail_code); break;
    case 6:
    case 7: replace(which, fail_code); break;
    case 8: set_mark(); break;
    case 9: go_back(fail_code); break;
    case 10: locate(b, fail_code); break;
    case 11: check_skin(); break;
    case 12: step(b, fail_code); break;
    case 13:
    case 14: pose(b); break;
    default:
        if (kind % 2) pose(b);
        look();
        move_blade(b, which, fail_code);
        break;
    }
    look();
}

static void end_case(void) {
    gx_body_destroy(w.body);
    gx_body_destroy(w.twin);
    gx_body_destroy(w.mark);
    gx_body_destroy(w.twin_mark);
    REQUIRE(own.blocks == NULL && twins.blocks == NULL, "blocks are lost");
    REQUIRE(!own.wrong && !twins.wrong, "a block was released with another size");
    REQUIRE(!own.overrun && !twins.overrun, "something was written behind a block");
}

static void drop_case(void) {
    release_all(&own);
    release_all(&twins);
}

static void test_bytes(const uint8_t *bytes, size_t size) {
    case_bytes b;
    const clock_t start = clock();
    unsigned char *room = w.bytes;
    const size_t length = w.room;
    int calls;
    double time;
    b.data = bytes;
    b.size = size;
    b.at = 0;
    memset(&w, 0, sizeof w);
    w.bytes = room;
    w.room = length;
    own = twins = plenty();
    case_make_mesh(&b, &w.mesh);
    own.grows = twins.grows = (int)(case_take(&b) % 2);
    if (w.mesh.elements == 0) return;
    w.body = create(&own);
    w.twin = create(&twins);
    REQUIRE(!w.body == !w.twin, "only one body is created");
    trace("%u nodes, %u elements, cubes of %g, from %g %g %g to %g %g %g\n", (unsigned)w.mesh.nodes,
          (unsigned)w.mesh.elements, w.mesh.cube, w.mesh.low[0], w.mesh.low[1], w.mesh.low[2], w.mesh.high[0],
          w.mesh.high[1], w.mesh.high[2]);
    if (w.body != NULL) {
        REQUIRE(gx_body_view(w.body, &w.view, NULL) == GX_OK, "view");
        w.volume = w.first_volume = w.view.volume;
        look();
        create_blade(&b, 0);
        for (calls = 0; calls < CALLS && b.at < b.size; calls++) act(&b);
    }
    end_case();
    time = (double)(clock() - start) / CLOCKS_PER_SEC;
    if (time > count.slowest) {
        count.slowest = time;
        count.slowest_seed = at.seed;
    }
}

static void begin_fuzz(void) {}

static void end_fuzz(void) {
    free(w.bytes);
    w.bytes = NULL;
}

static void print_counts(void) {
    printf("%llu moves, %llu of them cut, %llu calls refused, %llu out of memory, %llu tools carved, %llu copies, %llu "
           "restored, %llu steps, up to %llu fragments, the slowest case %llu: %.1f s",
           (unsigned long long)count.moves, (unsigned long long)count.cuts, (unsigned long long)count.refused,
           (unsigned long long)count.failed, (unsigned long long)count.carved, (unsigned long long)count.saved,
           (unsigned long long)count.restored, (unsigned long long)count.steps,
           (unsigned long long)count.most_fragments, (unsigned long long)count.slowest_seed, count.slowest);
}

static int take_option(const char *argument) {
    if (strcmp(argument, "--trace") != 0) return 0;
    traces = 1;
    return 1;
}
