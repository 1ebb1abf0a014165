/* test_colliders.c - pieces on rigid bodies of the caller's: what these carry, how they move pieces, how deep they are
   in them by exact shapes at many places of the skin. */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include <math.h>
#include "body.h"

static gx_collider collider_of(uint32_t id, uint32_t kind, double a, double b, double c, double x, double y, double z) {
    gx_collider collider;
    int k;
    memset(&collider, 0, sizeof collider);
    collider.id = id;
    collider.kind = kind;
    collider.size[0] = a;
    collider.size[1] = b;
    collider.size[2] = c;
    for (k = 0; k < 3; k++) collider.pose[5 * k] = 1;
    collider.pose[3] = x;
    collider.pose[7] = y;
    collider.pose[11] = z;
    return collider;
}

/* Turns a collider about its own origin, before any other turn. */
static void turn(gx_collider *c, int axis, double angle) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    int k;
    for (k = 0; k < 3; k++) {
        const double a = c->pose[4 * k + i], b = c->pose[4 * k + j];
        c->pose[4 * k + i] = cos(angle) * a + sin(angle) * b;
        c->pose[4 * k + j] = cos(angle) * b - sin(angle) * a;
    }
}

static void switch_on(gx_body *body) {
    gx_contact_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.friction = 0.5;
    ck_assert_int_eq(gx_body_contact(body, &desc, NULL), GX_OK);
}

static gx_step_report take(gx_body *body, const gx_step_desc *step) {
    gx_step_report report;
    gx_failure failure;
    const gx_result result = gx_body_step(body, step, &report, &failure);
    ck_assert_msg(result == GX_OK, "step: %s, %s %zu", gx_result_text(result), failure.field ? failure.field : "",
                  failure.index);
    return report;
}

static void give_speed(gx_body *body, double x, double y, double z) {
    const gx_view view = view_of(body);
    size_t i;
    for (i = 0; i < view.copy_count; i++) {
        view.velocity[3 * i] += x;
        view.velocity[3 * i + 1] += y;
        view.velocity[3 * i + 2] += z;
    }
}

static gx_motion motion_of(gx_body *body) {
    gx_motion motions[16];
    ck_assert_int_eq(gx_body_motion(body, motions, 16, NULL), GX_OK);
    return motions[0];
}

/* A bowl around the frame's origin, with the radius at user */
static double bowl(void *user, const double p[3], double normal[3]) {
    const double far = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]), *radius = (const double *)user;
    int k;
    for (k = 0; k < 3; k++) normal[k] = -3 * p[k]; /* of any length */
    return *radius - far;
}

/* Exact signed distance, told by other means than the library's */
static double distance_from(const gx_collider *c, const double x[3]) {
    double p[3], sum = 0, most = -1e300, along;
    int i, k;
    for (k = 0; k < 3; k++)
        for (p[k] = 0, i = 0; i < 3; i++) p[k] += c->pose[4 * i + k] * (x[i] - c->pose[4 * i + 3]);
    if (c->kind == GX_COLLIDER_PLANE) return p[2];
    if (c->kind == GX_COLLIDER_DISTANCE)
        return *(const double *)c->user - sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    if (c->kind == GX_COLLIDER_BOX) {
        for (k = 0; k < 3; k++) {
            most = fmax(most, fabs(p[k]) - c->size[k]);
            sum += pow(fmax(0, fabs(p[k]) - c->size[k]), 2);
        }
        return most > 0 ? sqrt(sum) : most;
    }
    along = c->kind == GX_COLLIDER_CAPSULE ? fmax(-c->size[1], fmin(c->size[1], p[2])) : 0;
    return sqrt(p[0] * p[0] + p[1] * p[1] + (p[2] - along) * (p[2] - along)) - c->size[0];
}

/* How deep colliders are in the body at most: at many places of each triangle of its skin */
static double depth_in(gx_body *body, const gx_collider *colliders, size_t count) {
    gx_skin skin;
    double *x, deepest = -1e300;
    size_t t, c;
    int i, j, k;
    memset(&skin, 0, sizeof skin);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    x = (double *)malloc((3 * skin.vertex_count + 1) * sizeof *x);
    ck_assert(x != NULL);
    ck_assert_int_eq(gx_body_skin_positions(body, x, NULL), GX_OK);
    for (t = 0; t < skin.triangle_count; t++)
        for (i = 0; i <= 8; i++)
            for (j = 0; i + j <= 8; j++) {
                const uint32_t *v = skin.triangles + 3 * t;
                double p[3];
                for (k = 0; k < 3; k++)
                    p[k] = (i * x[3 * (size_t)v[0] + (size_t)k] + j * x[3 * (size_t)v[1] + (size_t)k] +
                            (8 - i - j) * x[3 * (size_t)v[2] + (size_t)k]) /
                           8;
                for (c = 0; c < count; c++) deepest = fmax(deepest, -distance_from(&colliders[c], p));
            }
    free(x);
    return deepest;
}

static void advance(gx_collider *c, double dt) {
    int k;
    for (k = 0; k < 3; k++) c->pose[4 * k + 3] += dt * c->velocity[k];
}

/* Contacts of the last step against what colliders feel: equal to rounding, torques too. */
static void check_reaction(gx_body *body, const gx_step_desc *step) {
    static gx_contact contacts[4096];
    size_t count, i, c;
    int k;
    ck_assert_int_eq(gx_body_contacts(body, contacts, 4096, &count, NULL), GX_OK);
    for (c = 0; c < step->collider_count; c++) {
        const gx_collider *collider = &step->colliders[c];
        const gx_collider_load *load = &step->collider_loads[c];
        double force[3] = {0, 0, 0}, torque[3] = {0, 0, 0}, size = 0;
        uint32_t met = 0;
        for (i = 0; i < count; i++) {
            const double *f = contacts[i].force;
            double arm[3];
            if (contacts[i].collider != collider->id) continue;
            ck_assert_uint_eq(contacts[i].other, UINT32_MAX);
            for (k = 0; k < 3; k++) {
                arm[k] = contacts[i].position[k] - collider->pose[4 * k + 3] - step->dt * collider->velocity[k];
                force[k] -= f[k];
                size += fabs(f[k]);
            }
            for (k = 0; k < 3; k++) torque[k] -= arm[(k + 1) % 3] * f[(k + 2) % 3] - arm[(k + 2) % 3] * f[(k + 1) % 3];
            met++;
        }
        ck_assert_uint_le(met, load->contacts); /* friction may outlast the pressure */
        for (k = 0; k < 3 && met == load->contacts; k++) {
            ck_assert_double_le(fabs(load->force[k] - force[k]), 1e-12 * size);
            ck_assert_double_le(fabs(load->torque[k] - torque[k]), 1e-9 * size);
        }
    }
}

/* ---- at rest ---- */

/* The body lies on a collider of each kind, which then feels its weight. */
START_TEST(carry_weight) {
    static double radius = 9;
    gx_collider colliders[5];
    gx_collider_load loads[5];
    workload w = grid(3, 3, 2, 6);
    gx_body *body = body_of(&w);
    gx_step_desc step = falling(1.0 / 60);
    double carried[3] = {0, 0, 0}, weight;
    size_t i, count = 1;
    int frame, k;
    switch_on(body);
    switch (_i) {
    case 0: colliders[0] = collider_of(7, GX_COLLIDER_PLANE, 0, 0, 0, 5, -3, -0.02); break;
    case 1: colliders[0] = collider_of(7, GX_COLLIDER_BOX, 1.1, 1.2, 0.4, 1.5, 1.45, -0.42); break;
    case 2:
        for (i = 0, count = 2; i < 2; i++) {
            colliders[i] =
                collider_of(9 - (uint32_t)i, GX_COLLIDER_CAPSULE, 0.3, 3, 0, 0.6 + 1.8 * (double)i, 1.5, -0.33);
            turn(&colliders[i], 0, 1.5707963267948966);
        }
        break;
    case 3: /* feet that are smaller than elements, under the middle of facets */
        for (i = 0, count = 4; i < 4; i++)
            colliders[i] = collider_of((uint32_t)i, GX_COLLIDER_SPHERE, 0.25, 0, 0, 0.4 + 2 * (double)(i % 2),
                                       0.3 + 2 * (double)(i / 2), -0.27);
        break;
    default:
        colliders[0] = collider_of(UINT32_MAX - 1, GX_COLLIDER_DISTANCE, 0, 0, 0, 1.5, 1.5, 8.6);
        colliders[0].distance = bowl;
        colliders[0].user = &radius;
    }
    for (i = 0; i < count; i++) colliders[i].friction = 0.6;
    step.colliders = colliders;
    step.collider_count = count;
    step.collider_loads = loads;
    step.newton_iterations = 2;
    for (frame = 0; frame < 240; frame++) take(body, &step);
    step.newton_iterations = 10; /* to rest */
    step.cg_tolerance = 1e-6;
    step.integrator = GXS_BDF1;
    step.dt = 0.2;
    for (frame = 0; frame < 40; frame++) take(body, &step);
    check_reaction(body, &step);
    weight = motion_of(body).mass * 9.81;
    for (i = 0; i < count; i++)
        for (k = 0; k < 3; k++) carried[k] += loads[i].force[k];
    if (getenv("GXFEM_VERBOSE"))
        printf("kind %d: carries %g %g %g of %g, depth %g\n", _i, carried[0], carried[1], carried[2], weight,
               depth_in(body, colliders, count));
    ck_assert_double_lt(fabs(carried[2] + weight), 1e-4 * weight);
    ck_assert_double_lt(fabs(carried[0]) + fabs(carried[1]), 1e-4 * weight);
    ck_assert_double_lt(depth_in(body, colliders, count), _i == 3 ? 0.2 : 0.06);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A rigid ball on an elastic half-space, in a block that is held all around where the force at a point moves it: the
   force is 4/3 E / (1 - v^2) sqrt(R) depth^1.5 [Hertz], with two elements along the radius of the contact, which is 1
   m. `make bench-contact` refines them. */
START_TEST(as_hertz_says) {
    static const double out[7] = {0, 0.5, 1, 1.5, 2.33, 3.71, 6}, in[9] = {0, 0.5, 1, 1.5, 2, 2.65, 3.49, 4.59, 6};
    const double radius = 20, young = 1e6, poisson = 0.3, depth = 1 / radius, edge = 6 - 1e-6;
    const double push = 4.0 / 3 * young / (1 - poisson * poisson) * sqrt(radius) * pow(depth, 1.5);
    const double scale = push * (1 + poisson) / (2 * 3.14159265358979 * young);
    const gx_region sides[5] = {gx_region_half_space(0, -1, -edge), gx_region_half_space(0, 1, edge),
                                gx_region_half_space(1, -1, -edge), gx_region_half_space(1, 1, edge),
                                gx_region_half_space(2, -1, -edge)};
    workload w = grid(12, 12, 8, 5);
    gx_collider ball = collider_of(1, GX_COLLIDER_SPHERE, radius, 0, 0, 0, 0, radius - depth);
    gx_collider_load load;
    gx_contact_desc contact;
    gx_body_desc desc;
    gx_body *body = NULL;
    gx_step_desc step;
    gx_view view;
    double *targets;
    size_t i;
    int k;
    for (i = 0; i < w.node_count; i++) {
        double *x = w.positions + 3 * i;
        for (k = 0; k < 2; k++) x[k] = x[k] < 6 ? -out[6 - (int)(x[k] + 0.5)] : out[(int)(x[k] + 0.5) - 6];
        x[2] = -in[8 - (int)(x[2] + 0.5)];
    }
    desc = desc_of(&w);
    desc.young = young;
    desc.poisson = poisson;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    ck_assert_int_eq(gx_body_hold(body, sides, 5, NULL), GX_OK);
    memset(&contact, 0, sizeof contact);
    ck_assert_int_eq(gx_body_contact(body, &contact, NULL), GX_OK);
    view = view_of(body);
    targets = (double *)calloc(view.copy_count, 3 * sizeof *targets);
    for (i = 0; i < view.copy_count; i++) { /* by the force at a point [Boussinesq] */
        const double *x = view.positions + 3 * (size_t)view.copy_node[i], z = -x[2];
        const double r = sqrt(x[0] * x[0] + x[1] * x[1]), far = sqrt(r * r + z * z);
        if (!view.copy_held[i]) continue;
        for (k = 0; k < 2 && r > 0; k++)
            targets[3 * i + (size_t)k] = scale * (z / pow(far, 3) - (1 - 2 * poisson) / (far * (far + z))) * x[k];
        targets[3 * i + 2] = -scale * (z * z / pow(far, 3) + 2 * (1 - poisson) / far);
    }
    memset(&step, 0, sizeof step);
    step.dt = 100;
    step.integrator = GXS_STATIC;
    step.targets = targets;
    step.epoch = view.epoch;
    step.newton_iterations = 10;
    step.cg_tolerance = 1e-5;
    step.colliders = &ball;
    step.collider_loads = &load;
    step.collider_count = 1;
    for (k = 0; k < 4; k++) take(body, &step);
    if (getenv("GXFEM_VERBOSE")) printf("Hertz: %.4f of the force\n", load.force[2] / push);
    ck_assert_double_lt(fabs(load.force[2] / push - 1), 0.05);
    free(targets);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* What resists a small move of a collider, when nothing of the body gives way */
START_TEST(stiffness_by_differences) {
    workload w = grid(3, 3, 2, 6);
    gx_body *body = body_of(&w);
    const double low[3] = {-1, -1, -1}, high[3] = {4, 4, 4}, small = 1e-6;
    const gx_region all = gx_region_box(low, high);
    gx_collider c = collider_of(1, GX_COLLIDER_SPHERE, 1.3, 0, 0, 1.4, 1.7, -1.25), moved;
    gx_collider_load before, after;
    gx_step_desc step = falling(1.0 / 60);
    int i, j, frame;
    switch_on(body);
    ck_assert_int_eq(gx_body_hold(body, &all, 1, NULL), GX_OK);
    step.colliders = &c;
    step.collider_count = 1;
    step.collider_loads = &before;
    for (frame = 0; frame < 10; frame++) take(body, &step);
    ck_assert_double_gt(-before.force[2], 100);
    ck_assert_uint_gt(before.contacts, 2);
    step.colliders = &moved;
    step.collider_loads = &after;
    for (i = 0; i < 6; i++) {
        gx_body *clone = NULL;
        double size = 0;
        ck_assert_int_eq(gx_body_clone(body, &clone, NULL), GX_OK);
        switch_on(clone);
        step.colliders = &c;
        for (frame = 0; frame < 10; frame++) take(clone, &step);
        step.colliders = &moved;
        moved = c;
        if (i < 3)
            moved.pose[4 * i + 3] += small;
        else
            turn(&moved, i - 3, small);
        take(clone, &step);
        for (j = 0; j < 6; j++) size = fmax(size, fabs(before.stiffness[7 * j]));
        for (j = 0; j < 3; j++) { /* the normals of a sphere do not turn with it, only the places do */
            const double change = (after.force[j] - before.force[j]) / small;
            ck_assert_double_lt(fabs(before.stiffness[6 * i + j] - before.stiffness[6 * j + i]), 1e-9 * size);
            if (i < 3 && i == j) ck_assert_double_lt(fabs(change + before.stiffness[6 * j + i]), 0.1 * size);
        }
        if (i == 2)
            ck_assert_double_lt(fabs((after.force[2] - before.force[2]) / small + before.stiffness[14]), 0.02 * size);
        gx_body_destroy(clone);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A block that is held presses on a plane, without friction and at once: nothing holds the plane along itself. */
START_TEST(static_without_friction) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    const gx_region top = gx_region_half_space(2, 1, 0.9);
    gx_collider plane = collider_of(1, GX_COLLIDER_PLANE, 0, 0, 0, 0, 0, 0.01);
    gx_collider_load load;
    gx_step_desc step = falling(0);
    step.integrator = GXS_STATIC;
    switch_on(body);
    ck_assert_int_eq(gx_body_hold(body, &top, 1, NULL), GX_OK);
    step.colliders = &plane;
    step.collider_count = 1;
    step.collider_loads = &load;
    take(body, &step);
    take(body, &step);
    ck_assert_double_lt(load.force[2], -100);
    ck_assert_double_gt(load.stiffness[14], 1);
    ck_assert_double_lt(fabs(load.stiffness[0]), 1e-12 * load.stiffness[14]);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* ---- in motion ---- */

/* A block on a tilted plane: it slides as it should, or sticks. */
START_TEST(slides_or_sticks) {
    const double angle = 0.35, mu = _i == 0 ? 0.2 : 1.05 * tan(0.35);
    workload w = grid(3, 3, 2, 6);
    gx_body *body = body_of(&w);
    gx_collider plane = collider_of(0, GX_COLLIDER_PLANE, 0, 0, 0, 0, 0, -0.005);
    gx_step_desc step = falling(0.01);
    gx_motion before, after;
    gx_contact_desc desc;
    int frame;
    memset(&desc, 0, sizeof desc);
    desc.sticking_speed = 1e-3;
    desc.recovery = 2;
    ck_assert_int_eq(gx_body_contact(body, &desc, NULL), GX_OK);
    plane.friction = mu;
    step.colliders = &plane;
    step.collider_count = 1;
    for (frame = 0; frame < 40; frame++) take(body, &step);
    for (frame = 1; frame <= 100; frame++) {
        const double a = angle * frame / 100;
        step.gravity[0] = 9.81 * sin(a);
        step.gravity[2] = -9.81 * cos(a);
        take(body, &step);
    }
    for (frame = 0; frame < 100 * _i; frame++) take(body, &step);
    before = motion_of(body);
    for (frame = 0; frame < 40; frame++) take(body, &step);
    after = motion_of(body);
    if (getenv("GXFEM_VERBOSE"))
        printf("mu %g: acceleration %g, way %g\n", mu, (after.velocity[0] - before.velocity[0]) / 0.4,
               after.center[0] - before.center[0]);
    if (_i == 0)
        ck_assert_double_lt(
            fabs((after.velocity[0] - before.velocity[0]) / 0.4 - 9.81 * (sin(angle) - mu * cos(angle))),
            0.01 * 9.81 * sin(angle));
    else
        ck_assert_double_lt(fabs(after.center[0] - before.center[0]), 1e-3);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* v^2 / (2 mu g), and an error that halves with the step */
START_TEST(slip_distance) {
    double error[2];
    int i, frame;
    for (i = 0; i < 2; i++) {
        const double dt = i == 0 ? 0.005 : 0.0025, mu = 0.3, speed = 1;
        workload w = grid(2, 2, 1, 6);
        gx_body_desc desc = desc_of(&w);
        gx_body *body = NULL;
        gx_collider plane = collider_of(0, GX_COLLIDER_PLANE, 0, 0, 0, 0, 0, 0);
        gx_step_desc step = falling(dt);
        double start;
        desc.young = 1e8; /* else shear moves the centre by 2 % of the way */
        ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
        switch_on(body);
        plane.friction = mu;
        step.colliders = &plane;
        step.collider_count = 1;
        for (frame = 0; frame * dt < 0.5; frame++) take(body, &step);
        give_speed(body, speed, 0, 0);
        start = motion_of(body).center[0];
        for (frame = 0; frame * dt < 0.6; frame++) take(body, &step);
        error[i] = (motion_of(body).center[0] - start) / (speed * speed / (2 * mu * 9.81)) - 1;
        gx_body_destroy(body);
        wl_free(&w);
    }
    if (getenv("GXFEM_VERBOSE")) printf("slip distance: errors %g, %g\n", error[0], error[1]);
    ck_assert_double_lt(fabs(error[0]), 0.03);
    ck_assert_double_lt(fabs(error[1]), 0.7 * fabs(error[0]));
}
END_TEST

/* A belt carries the body along, a turntable turns it, a box pushes it before it. */
START_TEST(moving_colliders_move_bodies) {
    workload w = grid(2, 2, 1, 6);
    gx_body *body = body_of(&w);
    gx_collider colliders[2] = {collider_of(3, GX_COLLIDER_PLANE, 0, 0, 0, _i == 1 ? 0 : -2, 0, 0),
                                collider_of(5, GX_COLLIDER_BOX, 0.2, 3, 1, -0.4, 1, 1.05)};
    gx_step_desc step = falling(0.01);
    gx_motion start, end;
    int frame;
    switch_on(body);
    colliders[0].friction = _i == 2 ? 0.1 : 0.7;
    step.colliders = colliders;
    step.collider_count = _i == 2 ? 2 : 1;
    for (frame = 0; frame < 40; frame++) take(body, &step);
    start = motion_of(body);
    colliders[_i == 2].velocity[0] = _i == 1 ? 0 : 0.5;
    colliders[0].spin[2] = _i == 1 ? 0.4 : 0;
    for (frame = 0; frame < 200; frame++) {
        take(body, &step);
        advance(&colliders[_i == 2], step.dt);
        if (_i == 1) turn(&colliders[0], 2, step.dt * colliders[0].spin[2]);
    }
    end = motion_of(body);
    if (getenv("GXFEM_VERBOSE"))
        printf("moving %d: from %g %g to %g %g, speed %g %g, depth %g\n", _i, start.center[0], start.center[1],
               end.center[0], end.center[1], end.velocity[0], end.velocity[1],
               depth_in(body, colliders, step.collider_count));
    if (_i == 1) {
        const double angle = atan2(end.center[1], end.center[0]) - atan2(start.center[1], start.center[0]);
        ck_assert_double_lt(fabs(angle - 0.8), 0.03);
    } else
        ck_assert_double_lt(fabs(end.velocity[0] - 0.5), 0.01);
    ck_assert_double_lt(depth_in(body, colliders, step.collider_count), 0.05);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Small and fast colliders do not go through a body between two steps, nor between its vertices. */
START_TEST(fast_ones_are_caught) {
    workload w = grid(3, 3, 3, 6);
    gx_body_desc desc = desc_of(&w);
    gx_body *body = NULL;
    gx_collider c = _i == 0 ? collider_of(1, GX_COLLIDER_SPHERE, 0.3, 0, 0, 1.6, 1.4, 4)
                  : _i == 1 ? collider_of(1, GX_COLLIDER_CAPSULE, 0.1, 0.6, 0, 1.6, 1.4, 5)
                            : collider_of(1, GX_COLLIDER_BOX, 0.3, 0.3, 0.1, 1.6, 1.4, 4);
    gx_step_desc step = falling(0.01);
    double deepest = -1;
    int frame;
    desc.density = 20;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    switch_on(body);
    step.gravity[2] = 0;
    step.newton_iterations = 5;
    step.dt = 0.03;
    if (_i == 1) turn(&c, 1, 1.3);
    c.velocity[2] = -10; /* 0.3 of an element in each step */
    step.colliders = &c;
    step.collider_count = 1;
    for (frame = 0; frame < 25; frame++) {
        take(body, &step);
        advance(&c, step.dt);
        deepest = fmax(deepest, depth_in(body, &c, 1));
    }
    if (getenv("GXFEM_VERBOSE"))
        printf("fast %d: depth %g, the body at %g with %g m/s\n", _i, deepest, motion_of(body).center[2],
               motion_of(body).velocity[2]);
    ck_assert_double_lt(deepest, 0.3);
    ck_assert_double_lt(motion_of(body).velocity[2], -8);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A body that begins below the ground, or around a sphere, comes out, not faster than it may. */
START_TEST(deep_ones_come_out) {
    workload w = grid(2, 2, 2, 6);
    gx_body *body = body_of(&w);
    gx_collider c = _i == 0 ? collider_of(1, GX_COLLIDER_PLANE, 0, 0, 0, 0, 0, 1.5)
                            : collider_of(1, GX_COLLIDER_SPHERE, 2, 0, 0, 1.2, 0.9, -1);
    gx_step_desc step = falling(0.01);
    double fastest = 0, depth;
    int frame;
    switch_on(body);
    step.gravity[2] = 0;
    step.colliders = &c;
    step.collider_count = 1;
    for (frame = 0; frame < 150; frame++) {
        take(body, &step);
        fastest = fmax(fastest, fabs(motion_of(body).velocity[2]));
    }
    depth = depth_in(body, &c, 1);
    if (getenv("GXFEM_VERBOSE")) printf("deep %d: fastest %g, depth left %g\n", _i, fastest, depth);
    ck_assert_double_lt(depth, 1e-3);
    ck_assert_double_lt(fastest, 4);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A collider that is smaller than the elements presses on a block, by more than its own size, or begins inside. It
   stays in front of the skin, and is pushed out. */
START_TEST(small_ones_are_not_swallowed) {
    workload w = grid(4, 4, 4, 6);
    static const double half[3] = {0.6, 0.4, 0.3};
    const int inside = _i % 2;
    gx_collider c = _i < 2 ? collider_of(1, GX_COLLIDER_SPHERE, 0.6, 0, 0, 2.2, 1.9, 4.6)
                  : _i < 4 ? collider_of(1, GX_COLLIDER_CAPSULE, 0.4, 1.5, 0, 2.1, 1.9, 5.8)
                           : collider_of(1, GX_COLLIDER_BOX, 0.5, 0.4, 0.3, 2.2, 1.9, 4.4);
    gx_collider_load load;
    gx_step_desc step = falling(1.0 / 60);
    gx_body_desc desc = desc_of(&w);
    const gx_region base = gx_region_half_space(2, -1, 0.5);
    gx_body *body = NULL;
    double depth, most = 0;
    int frame;
    desc.young = 2e5;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    switch_on(body);
    ck_assert_int_eq(gx_body_hold(body, &base, 1, NULL), GX_OK);
    if (inside) c.pose[11] -= 1.7;
    c.velocity[2] = inside ? 0 : -2;
    step.colliders = &c;
    step.collider_loads = &load;
    step.collider_count = 1;
    for (frame = 0; frame < 180; frame++) {
        if (frame == 48) memset(c.velocity, 0, sizeof c.velocity);
        take(body, &step);
        check_reaction(body, &step);
        advance(&c, step.dt);
        depth = depth_in(body, &c, 1);
        most = fmax(most, depth);
        if (!inside && frame > 3) ck_assert_uint_gt(load.contacts, 0);
    }
    if (getenv("GXFEM_VERBOSE")) printf("small %d: depth %g, at most %g, force %g\n", _i, depth, most, load.force[2]);
    ck_assert_double_gt(load.force[2], 5 * hypot(load.force[0], load.force[1]));
    ck_assert_double_lt(depth, half[_i / 2]);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A cut through what stands on colliders leaves their load. */
START_TEST(cut_on_colliders) {
    workload w = grid(3, 3, 3, 6);
    gx_body *body = body_of(&w);
    gx_collider colliders[6] = {collider_of(0, GX_COLLIDER_PLANE, 0, 0, 0, 0, 0, -0.3),
                                collider_of(1, GX_COLLIDER_SPHERE, 0.3, 0, 0, 0.4, 0.4, -0.3),
                                collider_of(2, GX_COLLIDER_SPHERE, 0.3, 0, 0, 2.6, 0.4, -0.3),
                                collider_of(3, GX_COLLIDER_SPHERE, 0.3, 0, 0, 0.4, 2.6, -0.3),
                                collider_of(4, GX_COLLIDER_SPHERE, 0.3, 0, 0, 2.6, 2.6, -0.3),
                                collider_of(5, GX_COLLIDER_PLANE, 0, 0, 0, 0, 0, 0)};
    gx_collider_load loads[6];
    gx_step_desc step = falling(1.0 / 60);
    const size_t count = _i == 0 ? 5 : 6; /* two press on the same places */
    double before = 0, after = 0;
    size_t i;
    int frame;
    if (_i == 1) colliders[0].pose[11] = 0;
    for (i = 0; i < count; i++) colliders[i].friction = 0.5;
    switch_on(body);
    step.newton_iterations = 3;
    step.colliders = colliders;
    step.collider_count = count;
    step.collider_loads = loads;
    step.dt = 0.1; /* to rest */
    for (frame = 0; frame < 40; frame++) take(body, &step);
    step.dt = 1.0 / 60;
    for (frame = 0; frame < 5; frame++) take(body, &step);
    for (i = 0; i < count; i++) before += loads[i].force[2];
    add_axis_plane(&w, 0, 0.45);
    add_axis_plane(&w, 1, 2.5);
    cut_by(body, &w, 0, 2);
    take(body, &step);
    for (i = 0; i < count; i++) after += loads[i].force[2];
    if (getenv("GXFEM_VERBOSE")) printf("cut on colliders: %g to %g N\n", before, after);
    ck_assert_double_lt(before, -0.99 * 27000 * 9.81);
    ck_assert_double_lt(fabs(after - before), (_i == 0 ? 0.02 : 0.06) * fabs(before));
    if (_i == 1) {
        ck_assert_double_lt(loads[5].force[2], -1000);
        for (i = 0; i < 3; i++) /* with all that they had carried */
            ck_assert_double_lt(fabs(loads[0].force[i] - loads[5].force[i]), 1e-6 * fabs(loads[5].force[2]));
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Blocks on two boxes fall asleep. What moves, changes or goes wakes those that it carries, no others. */
START_TEST(asleep_on_colliders) {
    workload w = grid(5, 2, 1, 6);
    gx_body *body;
    gx_collider colliders[3] = {collider_of(4, GX_COLLIDER_BOX, 2, 2, 0.5, 1, 1, -0.5),
                                collider_of(2, GX_COLLIDER_BOX, 2, 2, 0.5, 5.2, 1, -0.5),
                                collider_of(9, GX_COLLIDER_SPHERE, 1, 0, 0, 0, 0, 50)};
    gx_step_desc step = falling(1.0 / 60);
    gx_step_report report;
    gx_view view;
    size_t i;
    int frame;
    if (_i < 8) add_axis_plane(&w, 0, 2.5);
    body = cut_at_once(&w);
    for (i = 0; i < 3; i++) colliders[i].friction = 0.5;
    if (_i >= 8) colliders[0].id = 12; /* one block lies on both boxes, and one of these is the last by its number */
    switch_on(body);
    view = view_of(body);
    for (i = 0; i < view.copy_count; i++) { /* apart, so that neither leans on the other */
        size_t c;
        for (c = 0; c < 4 * view.cell_count && view.cell_copies[c] != i;) c++;
        if (c < 4 * view.cell_count && view.fragment_center[3 * view.cell_fragment[c / 4]] > 2.5)
            view.displacement[3 * i] += 0.7;
    }
    step.colliders = colliders;
    step.collider_count = 3;
    step.sleep_speed = 0.01;
    step.sleep_time = 0.2;
    for (frame = 0; frame < 200; frame++) report = take(body, &step);
    ck_assert_int_eq(report.stop, GXS_STOP_ASLEEP);
    switch (_i) {
    case 0: colliders[0].velocity[0] = 1e-3; break; /* moves */
    case 1: colliders[0].pose[11] -= 0.2; break;    /* is elsewhere at once */
    case 2:
    case 8: colliders[0] = colliders[2]; break; /* is gone */
    case 3: colliders[0].size[0] += 0.1; break; /* has grown */
    case 4: colliders[0].id = 77; break;        /* is another one */
    case 6: colliders[0].id = 3; break;
    case 7: step.collider_count = 0; break; /* all are gone */
    default: colliders[2].pose[11] = 40;    /* touches nothing */
    }
    if (_i == 2 || _i == 8) step.collider_count = 2;
    report = take(body, &step);
    if (_i == 5 || _i == 9)
        ck_assert_int_eq(report.stop, GXS_STOP_ASLEEP);
    else {
        ck_assert_int_ne(report.stop, GXS_STOP_ASLEEP);
        ck_assert((report.active_unknowns < 3 * view_of(body).copy_count) == (_i < 7));
        ck_assert_uint_gt(report.active_unknowns, 0);
    }
    if (_i == 1 || _i == 2) {
        for (frame = 0; frame < 10; frame++) take(body, &step);
        view = view_of(body);
        ck_assert_double_lt(fmin(view.fragment_center[2], view.fragment_center[5]), 0.5);
    }
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* Not a number: anywhere; in its normal; at some heights; at heights between corners; where it only comes to */
/* A block that slides onto a plane, or presses on it so lightly that the speed decides how stiff the hold is: loads and
   state with 1 mm/s, which 0 stands for, and with more */
START_TEST(sticking_speed_has_a_default) {
    static const double speeds[3] = {0, 1e-3, 0.5};
    gx_collider_load loads[3];
    uint64_t hash[3];
    int i, frame;
    for (i = 0; i < 3; i++) {
        workload w = grid(1, 1, 1, 5);
        gx_body *body = body_of(&w);
        gx_collider plane = collider_of(1, GX_COLLIDER_PLANE, 0, 0, 0, 0, 0, 0);
        gx_step_desc step = falling(0.01);
        gx_contact_desc desc;
        memset(&desc, 0, sizeof desc);
        desc.sticking_speed = speeds[i];
        ck_assert_int_eq(gx_body_contact(body, &desc, NULL), GX_OK);
        plane.friction = 0.5;
        step.colliders = &plane;
        step.collider_count = 1;
        step.collider_loads = &loads[i];
        if (_i == 1) step.gravity[2] = -0.01;
        if (_i == 0) give_speed(body, 0.1, 0, 0);
        for (frame = 0; frame < 10; frame++) take(body, &step);
        ck_assert_uint_gt(loads[i].contacts, 0);
        ck_assert_double_gt(loads[i].stiffness[0], 0);
        hash[i] = gx_body_state_hash(body);
        gx_body_destroy(body);
        wl_free(&w);
    }
    ck_assert(hash[0] == hash[1] && hash[0] != hash[2]);
    ck_assert_mem_eq(loads[0].force, loads[1].force, sizeof loads[0].force);
    ck_assert_mem_eq(loads[0].stiffness, loads[1].stiffness, sizeof loads[0].stiffness);
    ck_assert_double_lt(loads[2].stiffness[0], 0.5 * loads[0].stiffness[0]); /* it holds on less */
}
END_TEST

/* A ball of a radius of 0.1 by its distance alone. Counts how often it is asked. */
static double small_ball(void *user, const double p[3], double normal[3]) {
    const double far = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    *(int *)user += 1;
    memcpy(normal, p, 3 * sizeof *normal);
    return far - 0.1;
}

/* A distance tells nothing of how small its body is: between the corners of a block it is met if that is told. */
START_TEST(small_things_are_met_if_told) {
    double force[2];
    int i, asked[2] = {0, 0};
    for (i = 0; i < 2; i++) {
        workload w = grid(1, 1, 1, 5);
        gx_body *body = body_of(&w);
        gx_collider ball = collider_of(1, GX_COLLIDER_DISTANCE, 0.1 * i, 0, 0, 0.47, 0.55, -0.09);
        gx_step_desc step = falling(0.01);
        gx_collider_load load;
        ball.distance = small_ball;
        ball.user = &asked[i];
        switch_on(body);
        step.colliders = &ball;
        step.collider_count = 1;
        step.collider_loads = &load;
        take(body, &step);
        force[i] = -load.force[2];
        gx_body_destroy(body);
        wl_free(&w);
    }
    ck_assert_double_gt(force[1], 1);
    ck_assert_double_lt(force[0], force[1]);
    ck_assert_int_lt(asked[0], asked[1]);
}
END_TEST

/* The plane z = 0 by a distance that tells too little from afar */
static double timid_plane(void *user, const double p[3], double normal[3]) {
    (void)user;
    normal[0] = normal[1] = 0;
    normal[2] = 1;
    return fmin(p[2], 0.021);
}

/* A fast block comes to such a plane: steps that small do not lead there within a frame, nor forever. */
START_TEST(timid_distances_do_not_hang) {
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    gx_collider plane = collider_of(1, GX_COLLIDER_DISTANCE, 0, 0, 0, 0, 0, -3);
    gx_step_desc step = falling(0.01);
    gx_collider_load load;
    plane.distance = timid_plane;
    switch_on(body);
    step.colliders = &plane;
    step.collider_count = 1;
    step.collider_loads = &load;
    give_speed(body, 0, 0, -200); /* 2 m of the 3 */
    take(body, &step);
    ck_assert_uint_eq(load.contacts, 0);
    give_speed(body, 0, 0, 199); /* 1 m/s: slow enough */
    step.dt = 0.1;
    while (load.contacts == 0 && motion_of(body).center[2] > -4) take(body, &step);
    ck_assert_uint_gt(load.contacts, 0);
    ck_assert_double_gt(motion_of(body).center[2], -2.7);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

/* A block on a plane that is taken away whole: nothing presses. Loads are not written where there is no collider. */
START_TEST(nothing_is_left) {
    workload w = grid(2, 1, 1, 5);
    gx_body *body = body_of(&w);
    gx_collider plane = collider_of(1, GX_COLLIDER_PLANE, 0, 0, 0, 0, 0, 0);
    gx_step_desc step = falling(0.01);
    gx_collider_load load;
    gx_surface tool;
    size_t count;
    switch_on(body);
    step.colliders = &plane;
    step.collider_count = 1;
    step.collider_loads = &load;
    take(body, &step);
    ck_assert_double_lt(load.force[2], 0);
    step.collider_count = 0;
    load.contacts = 77;
    take(body, &step);
    ck_assert_uint_eq(load.contacts, 77);
    step.collider_count = 1;
    add_box(&w, 1, -1, -1, -1, 3, 2, 2);
    tool = surface_of(&w.surfaces[0]);
    ck_assert_int_eq(gx_body_carve(body, &tool, NULL, NULL), GX_OK);
    take(body, &step);
    ck_assert(load.contacts == 0 && fabs(load.force[2]) <= 0);
    ck_assert_int_eq(gx_body_contacts(body, NULL, 0, &count, NULL), GX_OK);
    ck_assert_uint_eq(count, 0);
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static double wrong(void *user, const double p[3], double normal[3]) {
    const double nan = HUGE_VAL - HUGE_VAL, far = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    const int kind = *(const int *)user;
    int k;
    for (k = 0; k < 3; k++) normal[k] = kind == 3 ? p[k] : k == 2;
    if (kind == 1) normal[1] = nan;
    if (kind == 5) normal[0] = nan;
    if (kind == 6) normal[2] = nan;
    switch (kind) {
    case 0: return nan;
    case 2: return p[2] < 0.5 && p[2] > -0.5 ? HUGE_VAL : p[2];
    case 3: return p[2] > 0.1 && p[2] < 0.2 ? nan : far - 0.3;
    case 4: return p[2] > -0.1 && p[2] < 0.1 ? nan : p[2];
    default: return p[2];
    }
}

START_TEST(refusals) {
    static const char *const fields[13] = {
        "colliders.id",       "colliders.kind",     "colliders.size", "colliders.size",     "colliders.pose",
        "colliders.pose",     "colliders.velocity", "colliders.spin", "colliders.friction", "colliders.friction",
        "colliders.distance", "colliders.id",       "colliders.pose"};
    workload w = grid(1, 1, 1, 5);
    gx_body *body = body_of(&w);
    gx_collider colliders[2], good = collider_of(1, GX_COLLIDER_SPHERE, 1, 0, 0, 0, 0, -1);
    gx_step_desc step = falling(0.01);
    gx_failure failure;
    uint64_t state = gx_body_state_hash(body);
    int i, kind;
    step.colliders = colliders;
    step.collider_count = 2;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), GX_ERROR_SEQUENCE);
    ck_assert_str_eq(failure.field, "gx_body_contact");
    switch_on(body);
    step.colliders = NULL;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), GX_ERROR_ARGUMENT);
    ck_assert_str_eq(failure.field, "colliders");
    step.colliders = colliders;
    for (i = 0; i < 13; i++) {
        gx_collider *c = &colliders[1];
        const int infinite = i == 3 || i == 5 || i == 6 || i == 7 || i == 9;
        colliders[0] = colliders[1] = good;
        c->id = 2;
        switch (i) {
        case 0: c->id = UINT32_MAX; break;
        case 1: c->kind = 5; break;
        case 2: c->size[0] = -1; break;
        case 3: c->size[0] = HUGE_VAL; break;
        case 4: c->pose[0] = 1.1; break;
        case 5: c->pose[3] = HUGE_VAL; break;
        case 6: c->velocity[1] = HUGE_VAL; break;
        case 7: c->spin[2] = HUGE_VAL; break;
        case 8: c->friction = -1; break;
        case 9: c->friction = HUGE_VAL; break;
        case 10: c->kind = GX_COLLIDER_DISTANCE; break;
        case 11: c->id = 1; break;
        default: c->pose[0] = -1; /* a mirror */
        }
        ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), infinite ? GX_ERROR_NOT_FINITE : GX_ERROR_ARGUMENT);
        ck_assert_str_eq(failure.field, fields[i]);
        ck_assert_uint_eq(failure.index, 1);
        ck_assert(gx_body_state_hash(body) == state);
    }
    for (kind = 0; kind < 7; kind++) {
        colliders[0] = good;
        colliders[1] = collider_of(8, GX_COLLIDER_DISTANCE, 0, 0, 0, 0, 0, 0);
        colliders[1].distance = wrong;
        colliders[1].user = &kind;
        if (kind == 4) { /* reaches the body within the step */
            colliders[1].pose[11] = -0.5;
            colliders[1].velocity[2] = 100;
        }
        ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), GX_ERROR_NOT_FINITE);
        ck_assert_str_eq(failure.field, "colliders.distance");
        ck_assert_uint_eq(failure.index, 1);
        ck_assert(gx_body_state_hash(body) == state);
    }
    colliders[0].size[0] = -1;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), GX_ERROR_ARGUMENT);
    ck_assert(strcmp(failure.field, "colliders.size") == 0 && failure.index == 0);
    step.collider_count = (size_t)INT32_MAX;
    ck_assert_int_eq(gx_body_step(body, &step, NULL, &failure), GX_ERROR_LIMIT);
    ck_assert_str_eq(failure.field, "collider_count");
    gx_body_destroy(body);
    wl_free(&w);
}
END_TEST

static Suite *suite(void) {
    Suite *s = suite_create("colliders");
    TCase *tests = tcase_create("colliders");
    tcase_set_timeout(tests, 300);
    ADD_SOME(tests, carry_weight, 5);
    tcase_add_test(tests, as_hertz_says);
    tcase_add_test(tests, stiffness_by_differences);
    tcase_add_test(tests, static_without_friction);
    tcase_add_loop_test(tests, slides_or_sticks, 0, FEWER > 1 ? 1 : 2);
    tcase_add_test(tests, slip_distance);
    tcase_add_loop_test(tests, moving_colliders_move_bodies, 0, FEWER > 1 ? 1 : 3);
    tcase_add_loop_test(tests, fast_ones_are_caught, 0, 3);
    tcase_add_loop_test(tests, deep_ones_come_out, 0, 2);
    tcase_add_loop_test(tests, small_ones_are_not_swallowed, 0, 6);
    tcase_add_loop_test(tests, cut_on_colliders, 0, 2);
    tcase_add_loop_test(tests, asleep_on_colliders, 0, 10);
    tcase_add_loop_test(tests, sticking_speed_has_a_default, 0, 2);
    tcase_add_test(tests, small_things_are_met_if_told);
    tcase_add_test(tests, timid_distances_do_not_hang);
    tcase_add_test(tests, nothing_is_left);
    tcase_add_test(tests, refusals);
    suite_add_tcase(s, tests);
    return s;
}

int main(void) { return run_suite(suite()); }
