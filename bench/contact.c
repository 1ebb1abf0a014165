/* contact.c - contact of pieces: what it gets right, and what it costs.

   make bench-contact builds and runs it. It prints CSV and writes it to build/bench/contact.csv, and a table to stderr.
   usage: contact [FILE [--small]]; --small: smaller piles and blocks, fewer steps.

   Rows; h is the edge of a cell (an element's size is 1 to 1.26 h), `figure` beside `expected`:
       closed    a block cut in two, pressed: what the closed cut carries, of what the block carried before; expected:
                 a layer of thickness h / c, 1 / (1 + h / (c L)). parameter: c
       slide     acceleration on a slope of 0.35 rad, m/s2; parameter: friction
       slip      the way of a block that is stopped by friction, m; parameter: time step, s
       collide   two halves meet at 3 m/s: momentum that is gone, of what there was; parameter: friction
       energy    of the same: the most there was, of the start's
       pile      a block cut into `parameter` pieces falls on the ground: how deep pieces are in each other or below the
                 ground at the end, in h, by examples/gxoverlap.h, which shares nothing with contact; asleep_s: after
                 so long nothing moved any more (empty: it did at the end)
       flight    of the same: the deepest on the way, in h
       hertz     a rigid ball on an elastic half-space: force, of 4/3 E / (1 - v^2) sqrt(R) depth^1.5; parameter:
   elements along the radius of the contact. balls: two elastic balls in one body, likewise cost      a block cut into
   pieces by leaning planes; parameter: pieces. ms, first_ms: processor time of a step, mean and the first one after the
   cut; apart_ms: without the linear algebra; the same with contact off. figure: a step with contact, of one without */
#define _POSIX_C_SOURCE 200112L
#define BENCH           "contact"
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "../examples/gxoverlap.h"
#include "block.h"
#include "clock.h"
#include "csv.h"
#include "expect.h"
#include "progress.h"

enum { MOST_PLANES = 16, MOST_CONTACTS = 65536 };

typedef struct measured { /* steps, with and without contact */
    double mean, first, apart, iterations;
} measured;

/* A block of edge 1 m, but for its height */
static gx_body *make_body(uint32_t cells, double height, double young, double poisson) {
    block_mesh mesh;
    gx_body_desc desc;
    gx_body *body = NULL;
    size_t i;
    expect(block_make_mesh(cells, 0, &mesh) == GX_OK, "no memory");
    for (i = 0; i < mesh.side * mesh.side * mesh.side; i++) mesh.positions[3 * i + 2] *= height;
    memset(&desc, 0, sizeof desc);
    desc.positions = mesh.positions;
    desc.node_count = mesh.side * mesh.side * mesh.side;
    desc.elements = mesh.elements;
    desc.element_count = 5 * (size_t)cells * cells * cells;
    desc.young = young;
    desc.poisson = poisson;
    desc.density = 1000;
    desc.clock = processor_seconds;
    expect(gx_body_create(&desc, &body, NULL) == GX_OK, "no body");
    block_free_mesh(&mesh);
    return body;
}

/* Cuts by planes across each axis that lean by `lean`, each from one side to the other and back in turn. */
static void cut_into(gx_body *body, const uint32_t parts[3], double lean) {
    static const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    double vertices[MOST_PLANES][12];
    gx_surface sheets[MOST_PLANES];
    gx_cut_desc desc;
    size_t count = 0;
    uint32_t axis, i, c;
    memset(sheets, 0, sizeof sheets);
    memset(&desc, 0, sizeof desc);
    for (axis = 0; axis < 3; axis++)
        for (i = 1; i < parts[axis]; i++, count++) {
            expect(count < MOST_PLANES, "too many planes");
            for (c = 0; c < 4; c++) {
                double *x = vertices[count] + 3 * c;
                const double along = c == 1 || c == 2 ? 2 : -1, across = c >= 2 ? 2 : -1;
                x[axis] = (double)i / parts[axis] + 0.0131 + (i % 2 ? lean : -lean) * (along - 0.5);
                x[(axis + 1) % 3] = along;
                x[(axis + 2) % 3] = across;
            }
            sheets[count].vertices = vertices[count];
            sheets[count].vertex_count = 4;
            sheets[count].triangles = triangles;
            sheets[count].triangle_count = 2;
        }
    desc.surfaces = sheets;
    desc.surface_count = count;
    expect(gx_body_cut(body, &desc, NULL, NULL) == GX_OK, "no cut");
}

static void switch_on(gx_body *body, double stiffness, double friction, double recovery) {
    gx_contact_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.stiffness = stiffness;
    desc.friction = friction;
    desc.recovery = recovery;
    expect(gx_body_contact(body, &desc, NULL) == GX_OK, "no contact");
}

static gx_step_desc falling(double dt) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    step.gravity[2] = -9.81;
    return step;
}

static gx_collider ground_at(double height, double friction) {
    gx_collider plane;
    int k;
    memset(&plane, 0, sizeof plane);
    plane.kind = GX_COLLIDER_PLANE;
    for (k = 0; k < 3; k++) plane.pose[5 * k] = 1;
    plane.pose[11] = height;
    plane.friction = friction;
    return plane;
}

static void take(gx_body *body, const gx_step_desc *step, gx_step_report *report) {
    expect(gx_body_step(body, step, report, NULL) == GX_OK, "no step");
}

static gx_view view_of(gx_body *body) {
    gx_view view;
    expect(gx_body_view(body, &view, NULL) == GX_OK, "no view");
    return view;
}

/* Contacts of the last step; the deepest overlap, and the forces along the third axis */
static size_t contacts_of(gx_body *body, double *deepest, double *force) {
    static gx_contact contacts[MOST_CONTACTS];
    size_t count, i;
    expect(gx_body_contacts(body, contacts, MOST_CONTACTS, &count, NULL) == GX_OK, "no contacts");
    *deepest = *force = 0;
    for (i = 0; i < count; i++) {
        *deepest = contacts[i].depth > *deepest ? contacts[i].depth : *deepest;
        *force += fabs(contacts[i].force[2]);
    }
    return count;
}

/* Momentum along the third axis and kinetic energy of all pieces, motion of the first */
static double momentum_of(gx_body *body, double *energy, gx_motion *first) {
    static gx_motion motions[1024];
    const gx_view view = view_of(body);
    double momentum = 0;
    size_t i;
    expect(gx_body_motion(body, motions, 1024, NULL) == GX_OK, "no motion");
    for (i = 0, *energy = 0; i < view.fragment_count; i++) {
        momentum += motions[i].mass * motions[i].velocity[2];
        *energy += motions[i].energy;
    }
    *first = motions[0];
    return momentum;
}

static void tell(const char *scene, double parameter, double figure, double expected) {
    csv_row("%s,%g,,,%.9g,%.9g,,,,,,,,", scene, parameter, figure, expected);
    fprintf(stderr, "%-8s %8g %14.6g (%.6g)\n", scene, parameter, figure, expected);
}

static void press_closed_cut(uint32_t cells, double stiffness) {
    static const uint32_t parts[3] = {1, 1, 2};
    const double h = 1.0 / cells, pushed = 1e-5;
    const gx_region ends[2] = {gx_region_half_space(2, -1, 0.1 * h), gx_region_half_space(2, 1, 1 - 0.1 * h)};
    gx_body *body = make_body(cells, 1, 1e6, 0);
    gx_step_desc step = falling(0.1);
    double poses[24], deepest, force;
    int k;
    expect(gx_body_hold(body, ends, 2, NULL) == GX_OK, "nothing held");
    cut_into(body, parts, 0);
    switch_on(body, stiffness, 0.5, 0);
    memset(poses, 0, sizeof poses);
    for (k = 0; k < 3; k++) poses[5 * k] = poses[12 + 5 * k] = 1;
    poses[12 + 11] = -pushed;
    step.gravity[2] = 0;
    step.integrator = GXS_STATIC;
    step.region_poses = poses;
    step.newton_iterations = 30;
    step.cg_tolerance = 1e-8;
    for (k = 0; k < 3; k++) take(body, &step, NULL);
    contacts_of(body, &deepest, &force);
    tell("closed", stiffness, force / (1e6 * pushed), 1 / (1 + h / stiffness));
    gx_body_destroy(body);
}

static void slide(double friction) {
    const double angle = 0.35, slope = 9.81 * (sin(angle) - friction * cos(angle));
    const gx_collider plane = ground_at(-0.001, friction);
    gx_body *body = make_body(3, 0.3, 1e6, 0.4);
    gx_step_desc step = falling(0.01);
    gx_motion before, after;
    double energy;
    int i;
    switch_on(body, 0, friction, 0);
    step.colliders = &plane;
    step.collider_count = 1;
    for (i = 0; i < 240; i++) {
        const double a = angle * (i < 40 ? 0 : i < 140 ? i - 40 : 100) / 100;
        step.gravity[0] = 9.81 * sin(a);
        step.gravity[2] = -9.81 * cos(a);
        take(body, &step, NULL);
    }
    momentum_of(body, &energy, &before);
    for (i = 0; i < 40; i++) take(body, &step, NULL);
    momentum_of(body, &energy, &after);
    tell("slide", friction, (after.velocity[0] - before.velocity[0]) / 0.4, slope > 0 ? slope : 0);
    gx_body_destroy(body);
}

static void slip(double dt) {
    const double friction = 0.3, speed = 1;
    const gx_collider plane = ground_at(0, friction);
    gx_body *body = make_body(2, 0.3, 1e8, 0.4);
    gx_step_desc step = falling(dt);
    gx_motion before, after;
    gx_view view;
    double energy;
    size_t i;
    switch_on(body, 0, friction, 0);
    step.colliders = &plane;
    step.collider_count = 1;
    for (i = 0; (double)i * dt < 0.5; i++) take(body, &step, NULL);
    view = view_of(body);
    for (i = 0; i < view.copy_count; i++) view.velocity[3 * i] += speed;
    momentum_of(body, &energy, &before);
    for (i = 0; (double)i * dt < 0.6; i++) take(body, &step, NULL);
    momentum_of(body, &energy, &after);
    tell("slip", dt, after.center[0] - before.center[0], speed * speed / (2 * friction * 9.81));
    gx_body_destroy(body);
}

static void collide(uint32_t cells, double friction) {
    static const uint32_t parts[3] = {1, 1, 2};
    gx_body *body = make_body(cells, 1, 1e6, 0.4);
    gx_step_desc step = falling(0.01);
    gx_motion motions[2], first;
    gx_view view;
    double start, most, energy, before;
    size_t i;
    cut_into(body, parts, 0);
    switch_on(body, 0, friction, 0);
    view = view_of(body);
    expect(gx_body_motion(body, motions, 2, NULL) == GX_OK, "not two pieces");
    for (i = 0; i < 4 * view.cell_count; i++) { /* copies belong to one piece; most are met more than once */
        const uint32_t piece = view.cell_fragment[i / 4];
        const size_t copy = view.cell_copies[i];
        if (motions[piece].center[2] < motions[1 - piece].center[2]) continue;
        view.displacement[3 * copy] = 0.123;
        view.displacement[3 * copy + 2] = 0.05;
        view.velocity[3 * copy + 2] = -3;
    }
    step.gravity[2] = 0;
    step.newton_iterations = 3;
    step.newton_tolerance = 1e-10;
    step.cg_tolerance = 1e-6;
    before = momentum_of(body, &start, &first);
    for (i = 0, most = 0; i < 30; i++) {
        take(body, &step, NULL);
        momentum_of(body, &energy, &first);
        most = energy > most ? energy : most;
    }
    tell("collide", friction, fabs(momentum_of(body, &energy, &first) / before - 1), 0);
    tell("energy", friction, most / start, 1);
    gx_body_destroy(body);
}

/* ---- Hertz [Johnson, Contact Mechanics, chapter 4] ---- */

/* What is pressed: parts of half-spaces, boxes of half this edge, in radii of the contact, which is 1 m. They are held
   all around where the force at a point would move them. Balls are 20 times as large as the contact. */
static const double hertz_reach = 6, hertz_radius = 20, hertz_young = 1e6, hertz_poisson = 0.3;

/* The i-th of 0 ... count places from 0 to hertz_reach: even up to `fine`, `each` apart, then ever further apart */
static double graded(uint32_t i, uint32_t even, uint32_t count, double each) {
    double low = 1, high = 4, at = 0, step;
    uint32_t k;
    while (high - low > 1e-12) {
        const double ratio = 0.5 * (low + high);
        for (k = even, at = even * each, step = each; k < count; k++) at += step *= ratio;
        if (at < hertz_reach)
            low = ratio;
        else
            high = ratio;
    }
    for (k = 0, at = 0, step = each; k < i; k++) at += k < even ? each : (step *= low);
    return at;
}

/* Where the force `push` at the origin, along the third axis into a half-space below it, moves a place [Boussinesq] */
static void pushed_by(double push, const double x[3], double moved[3]) {
    const double r = sqrt(x[0] * x[0] + x[1] * x[1]), z = -x[2], far = sqrt(r * r + z * z);
    const double scale = push * (1 + hertz_poisson) / (2 * 3.14159265358979 * hertz_young);
    const double out = scale * (r * z / pow(far, 3) - (1 - 2 * hertz_poisson) * r / (far * (far + z)));
    moved[0] = r > 0 ? out * x[0] / r : 0;
    moved[1] = r > 0 ? out * x[1] / r : 0;
    moved[2] = -scale * (z * z / pow(far, 3) + 2 * (1 - hertz_poisson) / far);
}

/* The nodes and elements of one of two half-spaces, the lower or the upper one; curved: its surface is a ball's. */
static void fill_half_space(const block_mesh *mesh, uint32_t elements, int upper, double curved, double *positions,
                            uint32_t *corners) {
    const uint32_t cells = (uint32_t)mesh->side - 1, half = cells / 2, even = half / 2;
    const size_t nodes = mesh->side * mesh->side * mesh->side;
    const double each = (upper ? 0.93 : 1.0) / elements; /* so that nodes do not lie on each other */
    size_t i, first = upper ? nodes : 0;
    int k;
    for (i = 0; i < nodes; i++) {
        const uint32_t at[3] = {(uint32_t)(i % mesh->side), (uint32_t)(i / mesh->side % mesh->side),
                                (uint32_t)(i / mesh->side / mesh->side)};
        double *x = positions + 3 * (first + i);
        for (k = 0; k < 2; k++)
            x[k] = at[k] < half ? -graded(half - at[k], even, half, each) : graded(at[k] - half, even, half, each);
        x[2] = -graded(cells - at[2], half, cells, each);
        x[2] -= curved * (x[0] * x[0] + x[1] * x[1]) * (1 + x[2] / hertz_reach);
        if (upper) x[2] = -x[2];
    }
    for (i = 0; i < 20 * (size_t)cells * cells * cells; i++) /* a mirror image has two corners exchanged */
        corners[(upper ? 20 * (size_t)cells * cells * cells : 0) + i] =
            (uint32_t)(first + mesh->elements[upper && i % 4 > 1 ? i ^ 1 : i]);
}

static gx_body *make_half_spaces(uint32_t elements, int count) {
    const uint32_t cells = 4 * elements + 4;
    block_mesh mesh;
    gx_body_desc desc;
    gx_body *body = NULL;
    double *positions;
    uint32_t *corners;
    size_t nodes, tets = 5 * (size_t)cells * cells * cells;
    int i;
    expect(block_make_mesh(cells, 0, &mesh) == GX_OK, "no memory");
    nodes = mesh.side * mesh.side * mesh.side;
    positions = (double *)malloc((size_t)count * nodes * 3 * sizeof *positions);
    corners = (uint32_t *)malloc((size_t)count * tets * 4 * sizeof *corners);
    expect(positions != NULL && corners != NULL, "no memory");
    for (i = 0; i < count; i++)
        fill_half_space(&mesh, elements, i, count > 1 ? 0.25 / hertz_radius : 0, positions, corners);
    memset(&desc, 0, sizeof desc);
    desc.positions = positions;
    desc.node_count = (size_t)count * nodes;
    desc.elements = corners;
    desc.element_count = (size_t)count * tets;
    desc.young = hertz_young;
    desc.poisson = hertz_poisson;
    desc.density = 1000;
    expect(gx_body_create(&desc, &body, NULL) == GX_OK, "no body");
    block_free_mesh(&mesh);
    free(positions);
    free(corners);
    return body;
}

/* count: half-spaces. One is pressed by a rigid ball of radius R, two that are balls of radius 2 R by each other. */
static void hertz(uint32_t elements, int count) {
    const double edge = hertz_reach - 1e-6, depth = 1 / hertz_radius;
    const double modulus = hertz_young / (1 - hertz_poisson * hertz_poisson) / count;
    const double push = 4.0 / 3 * modulus * sqrt(hertz_radius) * pow(depth, 1.5);
    const gx_region sides[6] = {gx_region_half_space(0, -1, -edge), gx_region_half_space(0, 1, edge),
                                gx_region_half_space(1, -1, -edge), gx_region_half_space(1, 1, edge),
                                gx_region_half_space(2, -1, -edge), gx_region_half_space(2, 1, edge)};
    gx_body *body = make_half_spaces(elements, count);
    gx_step_desc step = falling(100);
    gx_collider ball = ground_at(hertz_radius - depth, 0);
    gx_collider_load load;
    gx_view view;
    double *targets, deepest, force;
    size_t i;
    expect(gx_body_hold(body, sides, 4 + (size_t)count, NULL) == GX_OK, "nothing held");
    switch_on(body, 0, 0, 0);
    view = view_of(body);
    targets = (double *)calloc(view.copy_count, 3 * sizeof *targets);
    expect(targets != NULL, "no memory");
    for (i = 0; i < view.copy_count; i++) {
        const double *x = view.positions + 3 * (size_t)view.copy_node[i];
        const double own[3] = {x[0], x[1], -fabs(x[2])};
        if (!view.copy_held[i]) continue;
        pushed_by(push, own, targets + 3 * i);
        if (x[2] > 0) targets[3 * i + 2] = -targets[3 * i + 2] - depth;
    }
    step.gravity[2] = 0;
    step.integrator = GXS_STATIC;
    step.targets = targets;
    step.epoch = view.epoch;
    step.newton_iterations = 10;
    step.cg_tolerance = 1e-5;
    if (count == 1) {
        ball.kind = GX_COLLIDER_SPHERE;
        ball.size[0] = hertz_radius;
        step.colliders = &ball;
        step.collider_loads = &load;
        step.collider_count = 1;
    }
    for (i = 0; i < 4; i++) take(body, &step, NULL);
    contacts_of(body, &deepest, &force);
    tell(count > 1 ? "balls" : "hertz", elements, (count > 1 ? force : load.force[2]) / push, 1);
    free(targets);
    gx_body_destroy(body);
}

/* How deep pieces are in each other, in themselves or below the ground */
static double overlap_of(gx_body *body, double ground, double tolerance) {
    gx_skin skin;
    gxoverlap_surface surface;
    gxoverlap_forest forest;
    double *positions, depth;
    memset(&skin, 0, sizeof skin);
    expect(gx_body_skin(body, NULL, &skin, NULL) == GX_OK, "no skin");
    positions = (double *)malloc(3 * skin.vertex_count * sizeof *positions);
    expect(positions != NULL && gx_body_skin_positions(body, positions, NULL) == GX_OK, "no positions");
    surface.positions = positions;
    surface.triangles = skin.triangles;
    surface.pieces = skin.triangle_fragment;
    surface.triangle_count = skin.triangle_count;
    expect(gxoverlap_make(&forest, &surface), "no memory");
    depth = fmax(gxoverlap_of_pieces(&forest, tolerance).depth, gxoverlap_of_itself(&forest).depth);
    depth = fmax(depth, gxoverlap_in_convex(&surface, gxoverlap_from_ground, &ground, tolerance).depth);
    gxoverlap_release(&forest);
    free(positions);
    return depth;
}

static void pile(uint32_t cells, const uint32_t parts[3], double time) {
    const double height = -0.05;
    const gx_collider plane = ground_at(height, 0.4);
    gx_body *body = make_body(cells, 1, 1e6, 0.3);
    gx_step_desc step = falling(1 / 60.0);
    gx_step_report report;
    double deepest, force, flight = 0, spent = 0, iterations = 0;
    char asleep[32] = "";
    const uint32_t steps = (uint32_t)(60 * time);
    uint32_t i;
    size_t count;
    gx_view view;
    cut_into(body, parts, 0.02);
    switch_on(body, 0, 0.4, 0);
    step.colliders = &plane;
    step.collider_count = 1;
    step.sleep_speed = 1e-2;
    step.sleep_time = 0.5;
    for (i = 0; i < steps; i++) {
        const double start = processor_seconds(NULL);
        take(body, &step, &report);
        spent += 1e3 * (processor_seconds(NULL) - start) / steps;
        iterations += report.cg_iterations;
        if (i % 10 == 0 && i < steps / 2) flight = fmax(flight, overlap_of(body, height, 0.01 / cells));
        if (report.stop != GXS_STOP_ASLEEP)
            asleep[0] = 0;
        else if (asleep[0] == 0)
            snprintf(asleep, sizeof asleep, "%.2f", i / 60.0);
    }
    count = contacts_of(body, &deepest, &force);
    deepest = overlap_of(body, height, 1e-3 / cells);
    view = view_of(body);
    csv_row("pile,%u,%lu,%lu,%.5f,0.05,%.3f,,,,%.1f,,,%s", parts[0] * parts[1] * parts[2],
            3 * (unsigned long)view.copy_count, (unsigned long)count, deepest * cells, spent, iterations / steps,
            asleep);
    tell("flight", parts[0] * parts[1] * parts[2], flight * cells, 0.3);
    fprintf(stderr, "%-8s %8u %14.6g (0.05) h deep, asleep %s s, %.1f ms a step\n", "pile",
            parts[0] * parts[1] * parts[2], deepest * cells, asleep, spent);
    gx_body_destroy(body);
}

/* Steps after a cut. The lowest layer is held. With contact off pieces go through each other, and those that are not
   held fall. */
static measured measure_steps(uint32_t cells, const uint32_t parts[3], double lean, int contact, uint32_t steps,
                              size_t *unknowns, size_t *contacts) {
    const gx_region floor_layer = gx_region_half_space(2, -1, 0.5 / cells);
    gx_body *body = make_body(cells, 1, 1e5, 0.3);
    gx_step_desc step = falling(1 / 60.0);
    measured m = {0, 0, 0, 0};
    double deepest, force;
    uint32_t i;
    expect(gx_body_hold(body, &floor_layer, 1, NULL) == GX_OK, "nothing held");
    if (contact) switch_on(body, 0, 0.3, 0);
    take(body, &step, NULL);
    cut_into(body, parts, lean);
    for (i = 0; i < steps; i++) {
        gx_step_report report;
        const double start = processor_seconds(NULL);
        double spent;
        take(body, &step, &report);
        spent = 1e3 * (processor_seconds(NULL) - start);
        m.mean += spent / steps;
        m.iterations += report.cg_iterations / (double)steps;
        m.apart += (spent - 1e3 * (report.seconds_linearise + report.seconds_prepare + report.seconds_solve)) / steps;
        if (i == 0) m.first = spent;
    }
    if (contact) *contacts = contacts_of(body, &deepest, &force);
    *unknowns = 3 * (size_t)view_of(body).copy_count;
    gx_body_destroy(body);
    return m;
}

static void cost(uint32_t cells, const uint32_t parts[3], double lean, uint32_t steps) {
    size_t unknowns = 0, contacts = 0;
    const measured off = measure_steps(cells, parts, lean, 0, steps, &unknowns, &contacts);
    const measured on = measure_steps(cells, parts, lean, 1, steps, &unknowns, &contacts);
    const uint32_t pieces = parts[0] * parts[1] * parts[2];
    csv_row("cost,%u,%lu,%lu,%.3f,2,%.3f,%.3f,%.3f,%.3f,%.1f,%.1f,%.3f,", pieces, (unsigned long)unknowns,
            (unsigned long)contacts, on.mean / off.mean, on.mean, off.mean, on.apart, off.apart, on.iterations,
            off.iterations, on.first);
    fprintf(stderr,
            "%-8s %8u %14.3f (2) of a step without: %.1f, %.1f ms; %.1f, %.1f apart from linear algebra; %.1f, %.1f "
            "iterations; first %.1f ms; %lu unknowns, %lu contacts\n",
            "cost", (unsigned)pieces, on.mean / off.mean, on.mean, off.mean, on.apart, off.apart, on.iterations,
            off.iterations, on.first, (unsigned long)unknowns, (unsigned long)contacts);
}

int main(int argc, char **argv) {
    static const uint32_t piles[3][3] = {{2, 2, 2}, {3, 3, 3}, {3, 4, 5}}, four[3] = {2, 2, 1}, many[3] = {3, 3, 3};
    static const double stiffness[3] = {10, 30, 100};
    int small, i;
    const char *path = csv_arguments(argc, argv, &small);
    csv_open(argv[0], path,
             "scene,parameter,unknowns,contacts,figure,expected,ms,ms_off,apart_ms,apart_off,cg,cg_off,first_ms,"
             "asleep_s");
    for (i = 0; i < 3; i++) press_closed_cut(4, stiffness[i]);
    slide(0.2);
    slide(1.05 * tan(0.35));
    slip(0.005);
    slip(0.0025);
    collide(3, 0.3);
    for (i = 2; i <= (small ? 2 : 8); i *= 2) hertz((uint32_t)i, 1);
    for (i = 2; i <= (small ? 2 : 8); i *= 2) hertz((uint32_t)i, 2);
    for (i = 0; i < (small ? 1 : 3); i++) pile(small ? 4 : 8, piles[i], small ? 2 : 4);
    cost(small ? 8 : 20, four, 0.1, small ? 10 : 60);
    cost(small ? 6 : 14, many, 0.02, small ? 10 : 60);
    return csv_close();
}
