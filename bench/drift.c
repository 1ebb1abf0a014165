/* drift.c - what each integrator does to the energy, the momenta and the motion of a free body, and with which
   order.

   usage: drift [FILE [--small]]; rows go to stdout and to FILE, a table with orders to stderr. --small: the same; it
   takes seconds.

   The body: 3 x 3 x 6 cubes of 0.2 m, five tetrahedra each, stable neo-Hookean, stretched along z at the start,
   spinning and flying, no gravity. Newton's method runs to 1e-12, so that the remaining error is the integrator's.
       energy_drift            largest (E - E_0) / E_0, kinetic + elastic, with its sign
       linear_momentum_drift   largest |p - p_0| / |p_0|
       angular_momentum_drift  largest |l - l_0| / |l_0|, about the origin
       position_error          |u - u_ref| / |X + u_ref - c| at the end, c: the centre; norms over nodes

   The reference is the implicit midpoint rule with the finest step, extrapolated with that of twice the step.
   Backward Euler and BDF2 keep linear momentum and lose energy and spin. The midpoint rule keeps both momenta to
   rounding and lets the energy oscillate. */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_SOLVE_IMPLEMENTATION
#include "../gxfem_solve.h"

#include "csv.h"
#include "forms.h"
#include "mesh.h"
#include "progress.h"

static const double pi = 3.14159265358979323846;
static const double duration = 1;                               /* s */
static const double length = 1.2, centre[3] = {0.3, 0.3, 0.6};  /* m */
static const double young = 2e3, density = 1000, strain = 0.15; /* Pa, kg/m3, about the largest along z */
static const double spin[3] = {0.3, -0.2, 0.8};                 /* rad/s */
static const double flight[3] = {0.4, 0.3, -0.2};               /* m/s */
static const double finest = 1.0 / 1920;                        /* s */

static const char *const integrator_name[] = {"BDF1", "BDF2", "midpoint"};

/* The quantities that should not change */
typedef struct invariants {
    double energy, linear[3], angular[3];
} invariants;

static void cross(const double a[3], const double b[3], double c[3]) {
    size_t r;
    for (r = 0; r < 3; r++) c[r] = a[(r + 1) % 3] * b[(r + 2) % 3] - a[(r + 2) % 3] * b[(r + 1) % 3];
}

static void position(const scene *s, size_t i, double x[3]) {
    size_t r;
    for (r = 0; r < 3; r++) x[r] = s->rest[3 * i + r] + s->displacement[3 * i + r];
}

/* p = sum (M v)_i, l = sum x_i x (M v)_i. With the consistent mass these are the field's. */
static invariants measure(const scene *s, double *momentum) {
    invariants now;
    size_t i, r;
    memset(&now, 0, sizeof now);
    now.energy = form_energy(&s->model, s->displacement);
    form_mass_product(&s->model, s->velocity, momentum);
    for (i = 0; i < s->model.copy_count; i++) {
        double x[3], turn[3];
        position(s, i, x);
        cross(x, momentum + 3 * i, turn);
        for (r = 0; r < 3; r++) {
            now.energy += 0.5 * s->velocity[3 * i + r] * momentum[3 * i + r];
            now.linear[r] += momentum[3 * i + r];
            now.angular[r] += turn[r];
        }
    }
    return now;
}

static double distance(const double a[3], const double b[3]) {
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

/* Largest deviations so far, relative */
typedef struct drift {
    double energy, linear, angular;
} drift;

static void drift_update(drift *d, const invariants *start, const invariants *now) {
    static const double zero[3] = {0, 0, 0};
    double energy = (now->energy - start->energy) / start->energy;
    if (fabs(energy) > fabs(d->energy)) d->energy = energy;
    d->linear = fmax(d->linear, distance(now->linear, start->linear) / distance(start->linear, zero));
    d->angular = fmax(d->angular, distance(now->angular, start->angular) / distance(start->angular, zero));
}

/* Pulls the body to the balance of forces M a with a smooth field a along z, that of its lowest vibration. The mass
   over a long step squared holds it against the sum of the forces. A body stretched like this gives little energy to
   the vibrations of single elements. A homogeneous stretch gives them much: its faces are not free of stress. No
   step here would resolve that motion, and orders would mean nothing. */
static void pull(scene *s) {
    gxs_step_desc step;
    size_t count = 3 * s->model.copy_count, i;
    double *a = (double *)memory(count, sizeof(double));
    for (i = 2; i < count; i += 3)
        a[i] = strain * young / density * pi / length * sin(pi * (s->rest[i] - centre[2]) / length);
    form_mass_product(&s->model, a, s->forces);
    memset(&step, 0, sizeof step);
    step.dt = 10;
    step.forces = s->forces;
    step.newton_iterations = 50;
    step.newton_tolerance = 1e-12;
    step.cg_tolerance = 1e-6;
    scene_step(s, &step);
    free(a);
}

static scene *free_body(void) {
    static const size_t n[3] = {3, 3, 6};
    const double size[3] = {0.6, 0.6, 1.2};
    mesh m = mesh_block(n, size, MESH_FIVE);
    scene *s = scene_make(&m, GXS_STABLE_NEO_HOOKEAN, young, 0.3, density);
    size_t i, r;
    pull(s);
    for (i = 0; i < m.node_count; i++) {
        double arm[3], turn[3];
        for (r = 0; r < 3; r++) arm[r] = s->rest[3 * i + r] + s->displacement[3 * i + r] - centre[r];
        cross(spin, arm, turn);
        for (r = 0; r < 3; r++) s->velocity[3 * i + r] = flight[r] + turn[r];
    }
    mesh_free(&m);
    return s;
}

/* Integrates the body over the duration; returns the scene at its end. */
static scene *run(gxs_integrator integrator, size_t steps, drift *worst) {
    scene *s = free_body();
    size_t count = 3 * s->model.copy_count, i;
    double *before = (double *)memory(2 * count, sizeof(double)), *momentum = (double *)memory(count, sizeof(double));
    invariants start = measure(s, momentum), now;
    gxs_step_desc step;
    memset(&step, 0, sizeof step);
    memset(worst, 0, sizeof *worst);
    step.dt = step.previous_dt = duration / (double)steps;
    step.integrator = integrator;
    step.newton_iterations = 50;
    step.newton_tolerance = 1e-12;
    step.cg_tolerance = 1e-6;
    for (i = 0; i < steps; i++) {
        double *kept = (double *)memory(2 * count, sizeof(double));
        memcpy(kept, s->displacement, count * sizeof(double));
        memcpy(kept + count, s->velocity, count * sizeof(double));
        step.previous_displacement = i > 0 ? before : NULL;
        step.previous_velocity = i > 0 ? before + count : NULL;
        scene_step(s, &step);
        free(before);
        before = kept;
        now = measure(s, momentum);
        drift_update(worst, &start, &now);
    }
    free(before);
    free(momentum);
    return s;
}

/* u_ref: two runs of the midpoint rule, extrapolated to remove the error of second order */
static double *reference(void) {
    size_t steps = (size_t)(duration / finest + 0.5), i;
    drift ignored;
    scene *fine = run(GXS_MIDPOINT, steps, &ignored), *coarse = run(GXS_MIDPOINT, steps / 2, &ignored);
    double *u = (double *)memory(3 * fine->model.copy_count, sizeof(double));
    for (i = 0; i < 3 * fine->model.copy_count; i++)
        u[i] = fine->displacement[i] + (fine->displacement[i] - coarse->displacement[i]) / 3;
    scene_free(fine);
    scene_free(coarse);
    return u;
}

/* Relative to the distances from the centre of mass, which has moved with the flight */
static double position_error(const scene *s, const double *u) {
    double error = 0, scale = 0;
    size_t i, r;
    for (i = 0; i < s->model.copy_count; i++)
        for (r = 0; r < 3; r++) {
            double away = s->rest[3 * i + r] + u[3 * i + r] - centre[r] - duration * flight[r];
            error += (s->displacement[3 * i + r] - u[3 * i + r]) * (s->displacement[3 * i + r] - u[3 * i + r]);
            scale += away * away;
        }
    return sqrt(error / scale);
}

enum { RATES = 5, RUNS = 3 * RATES };

static const size_t rates[RATES] = {30, 60, 120, 240, 480};

typedef struct result {
    drift worst;
    double error;
} result;

static result measure_rate(gxs_integrator kind, size_t rate, const double *u) {
    const size_t steps = (size_t)(duration * (double)rate + 0.5);
    result r;
    scene *s = run(kind, steps, &r.worst);
    r.error = position_error(s, u);
    scene_free(s);
    csv_row("%s,%.8f,%lu,%.6e,%.3e,%.3e,%.6e", integrator_name[kind], duration / (double)steps, (unsigned long)steps,
            r.worst.energy, r.worst.linear, r.worst.angular, r.error);
    return r;
}

/* Order: between a step and half of it */
static void print_table(const result *results) {
    size_t i;
    fprintf(stderr, "%-10s %6s %12s %6s %12s %12s %12s %6s\n", "integrator", "1/dt", "energy", "order", "linear mom.",
            "angular mom.", "position", "order");
    for (i = 0; i < RUNS; i++) {
        const result *r = &results[i];
        char energy[16] = "", place[16] = "";
        if (i % RATES > 0) {
            snprintf(energy, sizeof energy, "%.2f", log2(fabs(r[-1].worst.energy / r->worst.energy)));
            snprintf(place, sizeof place, "%.2f", log2(r[-1].error / r->error));
        }
        fprintf(stderr, "%-10s %6lu %12.3e %6s %12.1e %12.1e %12.3e %6s\n", integrator_name[i / RATES],
                (unsigned long)rates[i % RATES], r->worst.energy, energy, r->worst.linear, r->worst.angular, r->error,
                place);
    }
}

int main(int argc, char **argv) {
    result results[RUNS];
    double *u;
    int small;
    const char *path = csv_arguments(argc, argv, &small);
    size_t i;
    csv_open(argv[0], path,
             "integrator,dt,steps,energy_drift,linear_momentum_drift,angular_momentum_drift,position_error");
    progress_draw("drift", 0, RUNS + 1, "reference");
    u = reference();
    for (i = 0; i < RUNS; i++) {
        progress_draw("drift", i + 1, RUNS + 1, integrator_name[i / RATES]);
        results[i] = measure_rate((gxs_integrator)(GXS_BDF1 + (int)(i / RATES)), rates[i % RATES], u);
    }
    progress_draw("drift", RUNS + 1, RUNS + 1, "");
    print_table(results);
    free(u);
    return csv_close();
}
