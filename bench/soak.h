/* soak.h - lives of bodies that are cut again and again while they swing, fall, bounce and are kicked. Nothing may
   run away, and no energy may be gained.

   A life is a block of random size, lattice or jittered, of random materials, held at its top or free, above a floor
   with friction. Every third step cuts it: by a random plane, by one on a lattice plane or a unit in the last place
   off it, by a patch or by a solid box. Now and then every copy is kicked. A life ends after a number of steps or
   when there are many cells. See row for what is measured.

   Include after gxfem.h with its implementation. */
#ifndef GXFEM_BENCH_SOAK_H
#define GXFEM_BENCH_SOAK_H

#include "block.h"
#include "forms.h"
#include "splitmix.h"

#include <math.h>
#include <stdio.h>

enum { INTEGRATORS = 3, LIFE_STEPS = 100, MOST_CELLS = 4000 };

static const char *const integrator_names[INTEGRATORS] = {"BDF1", "BDF2", "midpoint"};
static const double carries = 0.01; /* share of an element */

typedef struct row {
    size_t lives, steps, cuts;
    size_t cells;  /* the most */
    size_t errors; /* calls that failed, and sums of volumes that are wrong */
    /* largest distance of a copy from the centre of its fragment, over that of the copies that carry a hundredth of
       an element or more, and over no less than the edge of the block */
    double reach;
    double speed; /* largest speed of a copy, over the largest so far of those copies */
    /* BDF1, BDF2: rise of the potential E that a step minimises, over the size of its terms; midpoint: rise of the
     * energy in a step, over the kinetic energy */
    double gain;
    double iterations; /* sum of conjugate gradients' iterations */
} row;

/* One life */
typedef struct life {
    gx_body *body;
    gx_step_desc step;
    gxs_plane floor;
    uint32_t cells; /* along an edge */
    int kicks, verbose;
    gxs_point *points;
    size_t point_count, point_room;
    double fastest; /* of the copies that carry something, so far, m/s */
    size_t done;
} life;

/* ---- random numbers ---- */

static uint64_t random_state;

static double uniform(void) { return ldexp((double)(splitmix64(&random_state) >> 11), -53); }

static int below(int n) { return (int)(uniform() * n); }

static double bell(void) {
    double sum = -6;
    int i;
    for (i = 0; i < 12; i++) sum += uniform();
    return sum;
}

static void *room(size_t count, size_t size) {
    void *memory = calloc(count + 1, size);
    if (!memory) {
        fprintf(stderr, "soak: no memory\n");
        exit(1);
    }
    return memory;
}

/* ---- a body ---- */

static gx_result make_body(life *l) {
    static const double density[3] = {1000, 2000, 500};
    gx_material material[3];
    block_mesh mesh;
    gx_body_desc desc;
    uint32_t *of;
    gx_result result;
    size_t i, elements;
    const int same = below(6);
    l->cells = 3 + (uint32_t)below(3);
    elements = 5 * (size_t)l->cells * l->cells * l->cells;
    memset(material, 0, sizeof material);
    memset(&desc, 0, sizeof desc);
    /* not GXS_LINEAR: loose fragments of it that tumble grow without end */
    for (i = 0; i < 3; i++) {
        material[i].elastic.kind = (gxs_material_kind)(same < 3 ? same : below(3));
        material[i].elastic.young = pow(10, 4 + 2 * uniform());
        material[i].elastic.poisson = below(4) ? 0.3 : 0.49;
        material[i].density = density[i];
    }
    if ((result = block_make_mesh(l->cells, below(2) ? 0.2 : 0, &mesh)) != GX_OK) return result;
    of = (uint32_t *)room(elements, sizeof *of);
    for (i = 0; i < elements; i++) of[i] = (uint32_t)below(3);
    desc.positions = mesh.positions;
    desc.node_count = mesh.side * mesh.side * mesh.side;
    desc.elements = mesh.elements;
    desc.element_count = elements;
    desc.materials = material;
    desc.material_count = 3;
    desc.element_materials = of;
    desc.support_below = below(4) ? 0 : 1e-3;
    result = gx_body_create(&desc, &l->body, NULL);
    free(of);
    block_free_mesh(&mesh);
    return result;
}

static gx_result begin_life(life *l, int integrator, uint64_t seed) {
    const gx_region top = gx_region_half_space(2, 1, 0.99);
    static const gxs_plane floor = {{0, 0, 1}, -0.3, 3e4, 0.3, 0};
    gx_result result;
    random_state = 3 * seed + (uint64_t)integrator;
    memset(l, 0, sizeof *l);
    l->floor = floor;
    result = make_body(l);
    if (result == GX_OK && below(2)) result = gx_body_hold(l->body, &top, 1, NULL);
    l->kicks = below(3) == 0;
    l->step.integrator = (gxs_integrator)integrator;
    l->step.dt = pow(10, -3 + 1.5 * uniform());
    l->step.gravity[2] = -9.81;
    l->step.newton_iterations = 1 + (uint32_t)below(4);
    return result;
}

static void end_life(life *l) {
    gx_body_destroy(l->body);
    free(l->points);
}

/* ---- cuts ---- */

static void normalise(double a[3]) {
    const double size = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    int k;
    for (k = 0; k < 3; k++) a[k] /= size;
}

static void choose_plane(const life *l, double centre[3], double normal[3]) {
    const int axis = below(3), lattice = below(3) == 0;
    double place = below((int)l->cells + 1) / (double)l->cells;
    int k;
    for (k = 0; k < 3; k++) centre[k] = uniform(), normal[k] = bell();
    normalise(normal);
    if (!lattice) return;
    k = below(3);
    if (k > 0 && place > 0) place = nextafter(place, k > 1 ? 2 : -1);
    for (k = 0; k < 3; k++) normal[k] = k == axis;
    centre[axis] = place;
}

/* A square across the normal, half its edge r */
static void make_square(const double centre[3], const double normal[3], double r, double *vertices) {
    const int axis = fabs(normal[0]) > 0.8;
    double u[3], w[3], help[3] = {0, 0, 0};
    int k, c;
    help[axis] = 1;
    for (k = 0; k < 3; k++) u[k] = normal[(k + 1) % 3] * help[(k + 2) % 3] - normal[(k + 2) % 3] * help[(k + 1) % 3];
    normalise(u);
    for (k = 0; k < 3; k++) w[k] = normal[(k + 1) % 3] * u[(k + 2) % 3] - normal[(k + 2) % 3] * u[(k + 1) % 3];
    for (c = 0; c < 4; c++)
        for (k = 0; k < 3; k++) vertices[3 * c + k] = centre[k] + (c % 3 ? r : -r) * u[k] + (c > 1 ? r : -r) * w[k];
}

static gx_result cut(life *l, gx_cut_report *report) {
    static const uint32_t square[6] = {0, 1, 2, 0, 2, 3};
    static const uint32_t box[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                     2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    double vertices[24], centre[3], normal[3];
    gx_surface surface;
    gx_cut_desc desc;
    int k, c;
    memset(&surface, 0, sizeof surface);
    memset(&desc, 0, sizeof desc);
    choose_plane(l, centre, normal);
    make_square(centre, normal, below(2) ? 5 : 0.1 + 0.6 * uniform(), vertices);
    surface.vertices = vertices;
    surface.vertex_count = 4;
    surface.triangles = square;
    surface.triangle_count = 2;
    if (below(12) == 0) {
        for (c = 0; c < 8; c++)
            for (k = 0; k < 3; k++) vertices[3 * c + k] = centre[k] + (c >> k & 1 ? 0.15 : 0);
        surface.vertex_count = 8;
        surface.triangles = box;
        surface.triangle_count = 12;
        surface.kind = GX_SURFACE_SOLID;
    }
    desc.surfaces = &surface;
    desc.surface_count = 1;
    return gx_body_cut(l->body, &desc, report, NULL);
}

/* Every third vertex of the skin is a point of contact. */
static gx_result find_points(life *l) {
    gx_skin skin;
    gx_result result = gx_body_skin(l->body, NULL, &skin, NULL);
    size_t i;
    l->point_count = 0;
    if (result != GX_OK) return result;
    if (skin.vertex_count > l->point_room) {
        free(l->points);
        l->point_room = 2 * skin.vertex_count;
        l->points = (gxs_point *)room(l->point_room, sizeof *l->points);
    }
    for (i = 0; i < skin.vertex_count; i += 3) l->points[l->point_count++] = gx_skin_point(&skin, (uint32_t)i);
    return GX_OK;
}

/* ---- measurement ---- */

/* U + floor - load, without inertia, J */
static double potential(const life *l, const gxs_model *model, const double *u, double *work) {
    const size_t n = 3 * model->copy_count;
    double energy = 0;
    size_t i;
    int k;
    energy = form_energy(model, u);
    for (i = 0; i < n; i++) work[i] = l->step.gravity[i % 3];
    form_mass_product(model, work, work + n);
    for (i = 0; i < n; i++) energy -= work[n + i] * u[i];
    for (i = 0; i < l->point_count; i++) {
        const gxs_point *point = &l->points[i];
        double depth = l->floor.offset - point->position[2];
        for (k = 0; k < 4; k++) depth -= point->weight[k] * u[3 * (size_t)point->copy[k] + 2];
        energy += depth > 0 ? 0.5 * l->floor.stiffness * depth * depth : 0;
    }
    return energy;
}

static double kinetic(const gxs_model *model, const double *v, double *work) {
    double energy = 0;
    size_t i;
    form_mass_product(model, v, work);
    for (i = 0; i < 3 * model->copy_count; i++) energy += 0.5 * work[i] * v[i];
    return energy;
}

/* The potential that a step must lower, from its start. u_0, v_0: before; u, v: after; past: displacement and
   velocity one step before, or NULL */
static double gain_of(const life *l, double previous_dt, double *const before[2], double *const past[2],
                      const gx_view *now) {
    const double dt = l->step.dt;
    const int midpoint = l->step.integrator == GXS_MIDPOINT;
    double *work, *at, r, first, rate, start, end, kinetic_start, kinetic_end;
    gxs_model model;
    size_t i, n;
    if (gx_body_model(l->body, &model, NULL) != GX_OK) return 1;
    n = 3 * model.copy_count;
    work = (double *)room(2 * n, sizeof *work);
    at = (double *)room(2 * n, sizeof *at);
    r = past ? dt / previous_dt : 0;
    first = past ? (1 + 2 * r) / (1 + r) : 1;
    rate = first / dt;
    for (i = 0; i < n; i++) {
        const double mean = past ? ((1 + r) * before[0][i] - r * r / (1 + r) * past[0][i]) / first : before[0][i];
        const double speed = past ? ((1 + r) * before[1][i] - r * r / (1 + r) * past[1][i]) / first : before[1][i];
        at[i] = midpoint ? before[1][i] : rate * (before[0][i] - mean) - speed;
        at[n + i] = midpoint ? now->velocity[i] : rate * (now->displacement[i] - mean) - speed;
    }
    kinetic_start = kinetic(&model, at, work);
    kinetic_end = kinetic(&model, at + n, work);
    start = potential(l, &model, before[0], work);
    end = potential(l, &model, now->displacement, work);
    free(work);
    free(at);
    r = midpoint ? fmax(kinetic_start, kinetic_end) + 1e-9 * fabs(start)
                 : fabs(start) + fabs(end) + kinetic_start + kinetic_end;
    return r > 0 ? (end + kinetic_end - start - kinetic_start) / r : 0;
}

/* For each copy the largest share of its element that a cell around it has */
static double *find_shares(const gx_body *body, const gx_view *view) {
    double *share = (double *)room(view->copy_count, sizeof *share);
    size_t i;
    int k;
    for (i = 0; i < view->cell_count; i++) {
        double x[12], gradients[12], volume = 1;
        gxp_element_positions(body, view->cell_element[i], x);
        (void)gxi_tet_gradients(x, gradients, &volume);
        for (k = 0; k < 4; k++)
            share[view->cell_copies[4 * i + (size_t)k]] =
                fmax(share[view->cell_copies[4 * i + (size_t)k]], view->cell_volume[i] / volume);
    }
    return share;
}

static const double no_place[3] = {0, 0, 0};

static double size_of(const double *a, const double *b) {
    double sum = 0;
    int k;
    for (k = 0; k < 3; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(sum);
}

/* A copy's position, m */
static void place_of(const life *l, const gx_view *view, size_t copy, double x[3]) {
    int k;
    for (k = 0; k < 3; k++)
        x[k] = l->body->mesh.positions[3 * (size_t)view->copy_node[copy] + (size_t)k] +
               view->displacement[3 * copy + (size_t)k];
}

/* How far copies are from the centre of their fragment, and how fast, relative to those that carry something */
static void measure_copies(life *l, const gx_view *view, row *r) {
    double *share = find_shares(l->body, view), furthest = 1, far = 0, fast = 0;
    gx_motion *motion = (gx_motion *)room(view->fragment_count, sizeof *motion);
    size_t i, worst[2] = {0, 0};
    int k;
    (void)gx_body_motion(l->body, motion, view->fragment_count, NULL);
    for (i = 0; i < view->cell_count; i++)
        for (k = 0; k < 4; k++) {
            const size_t copy = view->cell_copies[4 * i + (size_t)k];
            const double *centre = motion[view->cell_fragment[i]].center,
                         speed = size_of(view->velocity + 3 * copy, no_place);
            double x[3], distance;
            place_of(l, view, copy, x);
            distance = size_of(x, centre);
            if (share[copy] >= carries) furthest = fmax(furthest, distance), l->fastest = fmax(l->fastest, speed);
            if (!(distance <= far)) far = distance, worst[0] = copy;
            if (!(speed <= fast)) fast = speed, worst[1] = copy;
        }
    l->fastest = fmax(l->fastest, 9.81 * l->step.dt);
    if (l->verbose)
        printf("step %lu: cells %lu, copies %lu; furthest %.4g m of %.4g m (copy %lu, share %.3g), fastest %.4g m/s of "
               "%.4g m/s "
               "(copy %lu, share %.3g)\n",
               (unsigned long)l->done, (unsigned long)view->cell_count, (unsigned long)view->copy_count, far, furthest,
               (unsigned long)worst[0], share[worst[0]], fast, l->fastest, (unsigned long)worst[1], share[worst[1]]);
    r->reach = fmax(r->reach, far / furthest);
    r->speed = fmax(r->speed, fast / l->fastest);
    free(motion);
    free(share);
}

/* ---- lives ---- */

static void cut_now(life *l, row *r) {
    gx_cut_report report;
    gx_view view;
    double volume;
    memset(&view, 0, sizeof view);
    r->errors += gx_body_view(l->body, &view, NULL) != GX_OK;
    volume = view.volume;
    r->cuts++;
    r->errors += cut(l, &report) != GX_OK || find_points(l) != GX_OK || gx_body_view(l->body, &view, NULL) != GX_OK ||
                 fabs(view.volume + report.removed_volume - volume) > 1e-11;
}

static double *copied(const double *values, size_t count) {
    return (double *)memcpy(room(count, sizeof *values), values, count * sizeof *values);
}

/* Returns 0 at the end of the life. */
static int live_a_step(life *l, row *r) {
    gx_view view;
    gx_step_report report;
    double *before[2], *past[2] = {NULL, NULL}, previous_dt = l->body->copies.previous_dt, gain;
    size_t i, n;
    int k;
    if (l->done % 3 == 1) cut_now(l, r);
    if (gx_body_view(l->body, &view, NULL) != GX_OK || view.cell_count == 0 || view.cell_count > MOST_CELLS) return 0;
    n = 3 * view.copy_count;
    for (i = 0; l->kicks && l->done % 20 == 7 && i < n; i++)
        if (!view.copy_held[i / 3]) view.velocity[i] += 10 * bell();
    l->step.points = l->points;
    l->step.point_count = l->point_count;
    l->step.planes = &l->floor;
    l->step.plane_count = 1;
    before[0] = copied(view.displacement, n);
    before[1] = copied(view.velocity, n);
    for (k = 0; k < 2 && previous_dt > 0; k++) past[k] = copied(l->body->copies.history[k], n);
    if (gx_body_step(l->body, &l->step, &report, NULL) != GX_OK || gx_body_view(l->body, &view, NULL) != GX_OK) {
        r->errors++;
        l->done = LIFE_STEPS;
    } else {
        gain = gain_of(l, previous_dt, before, past[0] ? past : NULL, &view);
        r->gain = fmax(r->gain, gain);
        r->iterations += report.cg_iterations;
        measure_copies(l, &view, r);
        if (l->verbose)
            printf("    gain %.3g, %u iterations, residual %.2g\n", gain, report.cg_iterations, report.residual);
    }
    for (k = 0; k < 2; k++) {
        free(before[k]);
        free(past[k]);
    }
    r->cells = view.cell_count > r->cells ? view.cell_count : r->cells;
    r->steps++;
    return ++l->done < LIFE_STEPS;
}

static void run_life(int integrator, uint64_t seed, int verbose, row *r) {
    life l;
    r->lives++;
    if (begin_life(&l, integrator, seed) != GX_OK || find_points(&l) != GX_OK)
        r->errors++;
    else {
        l.verbose = verbose;
        while (live_a_step(&l, r)) continue;
    }
    end_life(&l);
}

#endif /* GXFEM_BENCH_SOAK_H */
