/* test_group.c - bodies that are stepped together. Two bodies do what one body of both meshes does, and what one alone
   does if it is the only one of its group. */
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "body.h"
#include "pool.h"

enum { MOST_BODIES = 3, MOST_PIECES = 16 };

typedef struct crowd {
    workload mesh[MOST_BODIES];
    gx_body *body[MOST_BODIES];
    size_t count;
    gx_group *group;
} crowd;

typedef struct body_like { /* of a body's kind */
    double affine_below, friction;
    const gx_allocator *allocator;
    const gx_jobs *jobs;
} body_like;

static gx_body *create_body(const workload *w, const body_like *like) {
    gx_body_desc desc = desc_of(w);
    gx_contact_desc contact;
    gx_body *made = NULL;
    memset(&contact, 0, sizeof contact);
    contact.friction = like->friction;
    desc.affine_below = like->affine_below;
    if (like->allocator != NULL) desc.allocator = *like->allocator;
    if (like->jobs != NULL) desc.jobs = *like->jobs;
    ck_assert_int_eq(gx_body_create(&desc, &made, NULL), GX_OK);
    ck_assert_int_eq(gx_body_contact(made, &contact, NULL), GX_OK);
    return made;
}

/* A block of n x n x m cubes of 1 / n at a place */
static workload block_at(size_t n, size_t m, double x, double y, double z) {
    workload w = grid(n, n, m, n % 2 ? 5 : 6);
    size_t i;
    const double at[3] = {x, y, z};
    for (i = 0; i < 3 * w.node_count; i++) w.positions[i] = w.positions[i] / (double)n + at[i % 3];
    return w;
}

/* One mesh of two, which share no node */
static workload united(const workload *a, const workload *b) {
    workload w = wl_empty();
    size_t i;
    for (i = 0; i < a->node_count; i++)
        wl_add_node(&w, a->positions[3 * i], a->positions[3 * i + 1], a->positions[3 * i + 2]);
    for (i = 0; i < b->node_count; i++)
        wl_add_node(&w, b->positions[3 * i], b->positions[3 * i + 1], b->positions[3 * i + 2]);
    for (i = 0; i < a->element_count; i++)
        wl_add_element(&w, a->elements[4 * i], a->elements[4 * i + 1], a->elements[4 * i + 2], a->elements[4 * i + 3]);
    for (i = 0; i < b->element_count; i++) {
        const uint32_t n = (uint32_t)a->node_count, *e = b->elements + 4 * i;
        wl_add_element(&w, n + e[0], n + e[1], n + e[2], n + e[3]);
    }
    return w;
}

static void gather(crowd *c) {
    gx_failure failure;
    ck_assert_msg(gx_group_create(c->body, c->count, &c->group, &failure) == GX_OK, "%s", failure.field);
}

/* A block on another, a little apart, over one of its edges or, further along x, two */
static crowd two_blocks(const body_like *like, double along) {
    crowd c;
    size_t i;
    memset(&c, 0, sizeof c);
    c.count = 2;
    c.mesh[0] = block_at(3, 3, 0, 0, 0);
    c.mesh[1] = block_at(2, 2, along, 0.1, 1.02);
    for (i = 0; i < 2; i++) c.body[i] = create_body(&c.mesh[i], like);
    gather(&c);
    return c;
}

static void let_go(crowd *c) {
    size_t i;
    gx_group_destroy(c->group);
    for (i = 0; i < c->count; i++) {
        gx_body_destroy(c->body[i]);
        wl_free(&c->mesh[i]);
    }
}

static void hold_low(gx_body *body, double z) {
    const gx_region region = gx_region_half_space(2, -1, z);
    ck_assert_int_eq(gx_body_hold(body, &region, 1, NULL), GX_OK);
}

static void cut_across(gx_body *body, int axis, double value) {
    workload w = wl_empty();
    add_axis_plane(&w, axis, value);
    (void)cut_by(body, &w, 0, 1);
    wl_free(&w);
}

static gx_step_report step_all(crowd *c, const gx_step_desc *steps) {
    gx_step_report report;
    gx_failure failure;
    const gx_result result = gx_group_step(c->group, steps, &report, &failure);
    ck_assert_msg(result == GX_OK, "step: %s, %s of body %d", gx_result_text(result),
                  failure.field ? failure.field : "", (int)failure.surface);
    return report;
}

/* The motions of all bodies' fragments, one body's after another's; returns how many */
static size_t motions_of(gx_body *const *bodies, size_t count, gx_motion *motions) {
    size_t i, n = 0;
    for (i = 0; i < count; n += view_of(bodies[i++]).fragment_count)
        ck_assert_int_eq(gx_body_motion(bodies[i], motions + n, MOST_PIECES - n, NULL), GX_OK);
    return n;
}

/* The largest difference of the places of fragments, m */
static double apart(gx_body *const *a, size_t a_count, gx_body *const *b, size_t b_count) {
    gx_motion one[MOST_PIECES], other[MOST_PIECES];
    const size_t n = motions_of(a, a_count, one);
    double most = 0;
    size_t i;
    int k;
    ck_assert_uint_eq(n, motions_of(b, b_count, other));
    for (i = 0; i < n; i++)
        for (k = 0; k < 3; k++) most = fmax(most, fabs(one[i].center[k] - other[i].center[k]));
    return most;
}

/* Momentum of all bodies, kg m/s */
static void momentum_of(gx_body *const *bodies, size_t count, double p[3]) {
    gx_motion motions[MOST_PIECES];
    const size_t n = motions_of(bodies, count, motions);
    size_t i;
    int k;
    for (k = 0; k < 3; k++)
        for (i = 0, p[k] = 0; i < n; i++) p[k] += motions[i].mass * motions[i].velocity[k];
}

static gx_collider ground(double friction) {
    gx_collider floor;
    memset(&floor, 0, sizeof floor);
    floor.kind = GX_COLLIDER_PLANE;
    floor.friction = friction;
    floor.pose[0] = floor.pose[5] = floor.pose[10] = 1;
    return floor;
}

enum { PLAIN, BDF2, AFFINE, KINDS };

/* Steps of a kind; each is well solved, unless sheets are affine */
static void describe_steps(int kind, gx_step_desc *steps, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        steps[i] = falling(1.0 / 60);
        steps[i].cg_tolerance = kind == AFFINE ? 1e-2 : 1e-6;
        steps[i].newton_iterations = kind == AFFINE ? 1 : 3;
        steps[i].integrator = kind == BDF2 ? GXS_BDF2 : GXS_BDF1;
    }
}

/* ---- against one body ---- */

/* A group of one does what its body does alone, to the bit. */
START_TEST(one_is_as_alone) {
    const body_like like = {_i == AFFINE ? 1 : 0, 0.3, NULL, NULL};
    const gx_collider floor = ground(0.4);
    crowd c;
    gx_body *alone;
    gx_step_desc step;
    gx_collider_load loads[2];
    int i;
    memset(&c, 0, sizeof c);
    c.count = 1;
    c.mesh[0] = block_at(2, 2, 0, 0, 0.03);
    c.body[0] = create_body(&c.mesh[0], &like);
    alone = create_body(&c.mesh[0], &like);
    for (i = 0; i < 2; i++) cut_across(i ? alone : c.body[0], 2, _i == AFFINE ? 0.55 : 0.77);
    gather(&c);
    describe_steps(_i, &step, 1);
    step.colliders = &floor;
    step.collider_count = 1;
    step.gravity[0] = 2;
    for (i = 0; i < 40; i++) {
        size_t counts[2];
        step.collider_loads = &loads[0];
        ck_assert_int_eq(gx_body_step(alone, &step, NULL, NULL), GX_OK);
        step.collider_loads = &loads[1];
        (void)step_all(&c, &step);
        ck_assert_msg(gx_body_state_hash(alone) == gx_body_state_hash(c.body[0]), "step %d", i);
        ck_assert_mem_eq(&loads[0], &loads[1], sizeof *loads);
        ck_assert_int_eq(gx_body_contacts(alone, NULL, 0, &counts[0], NULL),
                         gx_group_contacts(c.group, NULL, 0, &counts[1], NULL));
        ck_assert_uint_eq(counts[0], counts[1]);
    }
    ck_assert(loads[0].contacts > 0 && loads[0].force[2] < 0);
    for (i = 0; i < 2; i++) cut_across(i ? alone : c.body[0], 0, 0.41);
    alone->model.state = GXP_MODEL_STALE; /* told whole, as a group's solver is */
    for (i = 0; i < 20; i++) {
        ck_assert_int_eq(gx_body_step(alone, &step, NULL, NULL), GX_OK);
        (void)step_all(&c, &step);
        ck_assert_msg(gx_body_state_hash(alone) == gx_body_state_hash(c.body[0]), "step %d after the cut", i);
    }
    gx_body_destroy(alone);
    let_go(&c);
}
END_TEST

/* Two bodies that fall on each other do what one body of both meshes does. Sums round differently. */
START_TEST(two_are_as_one) {
    const body_like like = {0, 0.3, NULL, NULL};
    crowd c = two_blocks(&like, 0.4);
    workload both = united(&c.mesh[0], &c.mesh[1]);
    gx_body *one = create_body(&both, &like);
    gx_step_desc steps[2];
    gx_group_contact contacts[400];
    size_t count, between = 0, j;
    double most = 0;
    int i;
    hold_low(one, 0.1);
    hold_low(c.body[0], 0.1);
    describe_steps(_i, steps, 2);
    steps[0].gravity[1] = 1;
    steps[1].gravity[2] = 100; /* not read */
    for (i = 0; i < 40; i++) {
        if (i == 20) {
            cut_across(one, 0, 0.55);
            cut_across(c.body[0], 0, 0.55);
            cut_across(c.body[1], 0, 0.55);
        }
        ck_assert_int_eq(gx_body_step(one, &steps[0], NULL, NULL), GX_OK);
        (void)step_all(&c, steps);
        most = fmax(most, apart(&one, 1, c.body, 2));
        ck_assert_int_eq(gx_group_contacts(c.group, contacts, 400, &count, NULL), GX_OK);
        for (j = 0; j < count; j++) {
            const gx_group_contact *own = &contacts[j];
            ck_assert(own->body < 2 && own->other_body < 2);
            ck_assert_uint_lt(own->contact.fragment, view_of(c.body[own->body]).fragment_count);
            ck_assert_uint_lt(own->contact.other, view_of(c.body[own->other_body]).fragment_count);
            between += own->body != own->other_body;
        }
    }
    ck_assert_msg(most < 1e-5, "%g m apart", most);
    ck_assert_uint_gt(between, 0);
    gx_body_destroy(one);
    wl_free(&both);
    let_go(&c);
}
END_TEST

/* An anchor at a point of a body */
static gx_anchor anchor_at(gx_body *body, double x, double y, double z) {
    const double place[3] = {x, y, z};
    gx_hit hit;
    gx_anchor anchor;
    ck_assert_int_eq(gx_body_locate(body, place, 1, &hit, NULL), GX_OK);
    ck_assert_int_eq(gx_body_anchor(body, hit.element, hit.material, &anchor, NULL), GX_OK);
    return anchor;
}

/* What acts on a body of a group, and what comes back, is what acts on it alone: no matter what is beside it. Copies
   are affine in the body of kind 1, and the other one has elements of another size. */
typedef struct loads {
    gx_anchor at[4];
    gxs_spring spring;
    gxs_pair pair;
    double force[3], spring_force[3], slip[3], pair_force[3], poses[12];
} loads;

static void act_on(gx_body *body, loads *l, gx_step_desc *step) {
    memset(l, 0, sizeof *l);
    l->at[0] = anchor_at(body, 5.9, 0.4, 0.3);
    l->at[1] = anchor_at(body, 5.8, 0.6, 0.2);
    l->at[2] = anchor_at(body, 5.5, 0.5, 0.5);
    l->at[3] = anchor_at(body, 5.7, 0.5, 0.45);
    l->spring.stiffness = 400;
    l->spring.target[0] = 6.5;
    l->spring.target[2] = 1;
    l->pair.stiffness = 100;
    l->pair.offset = 1;
    l->pair.normal[2] = 1;
    l->pair.friction = 0.5;
    l->force[1] = 150;
    l->poses[0] = l->poses[5] = l->poses[10] = 1;
    l->poses[3] = 0.05;
    step->springs = &l->spring;
    step->spring_anchors = &l->at[0];
    step->spring_forces = l->spring_force;
    step->spring_count = 1;
    step->force_anchors = &l->at[1];
    step->anchor_forces = l->force;
    step->force_count = 1;
    step->pairs = &l->pair;
    step->pair_anchors = &l->at[2];
    step->pair_slips = l->slip;
    step->pair_forces = l->pair_force;
    step->pair_count = 1;
    step->region_poses = l->poses;
}

START_TEST(loads_are_the_bodies_own) {
    const body_like like = {_i ? 1 : 0, 0.3, NULL, NULL}, plain = {0, 0, NULL, NULL};
    const gx_region root = gx_region_half_space(0, -1, 5.1);
    gx_body *alone;
    crowd c;
    gx_step_desc steps[2], own;
    loads in_group, by_itself;
    double moved;
    int i, k;
    memset(&c, 0, sizeof c);
    c.count = 2;
    c.mesh[0] = block_at(3, 2, 0, 0, 0);
    c.mesh[1] = block_at(2, 1, 5, 0, 0);
    c.body[0] = create_body(&c.mesh[0], &plain);
    c.body[1] = create_body(&c.mesh[1], &like);
    alone = create_body(&c.mesh[1], &like);
    cut_across(alone, 2, 0.4);
    cut_across(c.body[1], 2, 0.4);
    ck_assert_int_eq(gx_body_hold(alone, &root, 1, NULL), GX_OK);
    ck_assert_int_eq(gx_body_hold(c.body[1], &root, 1, NULL), GX_OK);
    gather(&c);
    for (i = 0; i < 2; i++) steps[i] = falling(0.01);
    steps[0].cg_tolerance = 1e-4;
    steps[0].newton_iterations = 4;
    own = steps[0];
    act_on(c.body[1], &in_group, &steps[1]);
    act_on(alone, &by_itself, &own);
    for (i = 0; i < 20; i++) {
        ck_assert_int_eq(gx_body_step(alone, &own, NULL, NULL), GX_OK);
        (void)step_all(&c, steps);
    }
    moved = apart(&alone, 1, &c.body[1], 1);
    ck_assert_msg(moved < 1e-4, "%g m apart", moved);
    for (k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(in_group.spring_force[k], by_itself.spring_force[k], 0.3);
        ck_assert_double_eq_tol(in_group.pair_force[k], by_itself.pair_force[k], 0.3);
        ck_assert_double_eq_tol(in_group.slip[k], by_itself.slip[k], 1e-4);
    }
    ck_assert(fabs(by_itself.spring_force[2]) > 10 && by_itself.pair_force[2] > 1);
    gx_body_destroy(alone);
    let_go(&c);
}
END_TEST

/* ---- what must hold of any group ---- */

/* Bodies that collide in space keep the sum of their momenta. They rub by the mean of their coefficients. */
START_TEST(momentum_stays) {
    const body_like like = {0, 0.8, NULL, NULL}, other = {0, 0, NULL, NULL};
    crowd c = two_blocks(&like, 0.2);
    gx_step_desc steps[2];
    double before[3], after[3];
    size_t between = 0, j;
    uint32_t n;
    int i, k;
    gx_group_destroy(c.group);
    gx_body_destroy(c.body[1]);
    c.body[1] = create_body(&c.mesh[1], &other);
    gather(&c);
    describe_steps(PLAIN, steps, 2);
    for (i = 0; i < 2; i++) {
        const gx_view view = view_of(c.body[i]);
        for (j = 0; j < view.copy_count; j++) {
            view.velocity[3 * j + 2] = i ? -2 : 0.5;
            view.velocity[3 * j] = i ? 1 : 0;
        }
    }
    memset(steps[0].gravity, 0, sizeof steps[0].gravity);
    momentum_of(c.body, 2, before);
    for (i = 0; i < 30; i++) {
        (void)step_all(&c, steps);
        for (n = 0; n < c.group->all->touch.found; n++) {
            const gxp_touch *t = &c.group->all->touch;
            const gxp_touch_surface *surface = &t->surfaces[0];
            const uint32_t beside = surface->vertices[surface->facets[t->pairs[n].facet].vertex[0]].member;
            const double mean[2] = {0.8, 0};
            const uint32_t own = gxp_sample_vertex(surface, t->pairs[n].sample)->member;
            ck_assert_double_eq(c.group->all->attached.pairs[n].friction, (mean[own] + mean[beside]) / 2);
            between += own != beside && t->pairs[n].pressed > 0;
        }
    }
    ck_assert_uint_gt(between, 0);
    momentum_of(c.body, 2, after);
    for (k = 0; k < 3; k++) ck_assert_double_eq_tol(after[k], before[k], 1e-6 * fabs(before[2]));
    let_go(&c);
}
END_TEST

/* Saved and read again, or put back to a clone, bodies go on in a new group with the same bits. */
START_TEST(goes_on_after_saving) {
    const body_like like = {0, 0.4, NULL, NULL};
    crowd c = two_blocks(&like, 0.2), d;
    gx_step_desc steps[2];
    uint64_t state[2];
    int i, n;
    memset(&d, 0, sizeof d);
    d.count = 2;
    hold_low(c.body[0], 0.1);
    describe_steps(_i % 2 ? BDF2 : PLAIN, steps, 2);
    for (n = 0; n < 10 || c.body[1]->touch.surfaces[c.body[1]->touch.current].state_count == 0; n++)
        (void)step_all(&c, steps);
    for (i = 0; i < 2; i++) {
        ck_assert_int_eq(gx_body_clone(c.body[i], &d.body[i], NULL), GX_OK);
        ck_assert(gx_body_state_hash(c.body[i]) == gx_body_state_hash(d.body[i]));
    }
    if (_i >= 2) { /* go elsewhere, then back */
        cut_across(c.body[1], 0, 0.5);
        for (n = 0; n < 5; n++) (void)step_all(&c, steps);
        for (i = 0; i < 2; i++) ck_assert_int_eq(gx_body_restore(c.body[i], d.body[i], NULL), GX_OK);
    }
    gx_group_destroy(c.group);
    gather(&c);
    gather(&d);
    for (n = 0; n < 10; n++) {
        (void)step_all(&c, steps);
        (void)step_all(&d, steps);
        for (i = 0; i < 2; i++) ck_assert(gx_body_state_hash(c.body[i]) == gx_body_state_hash(d.body[i]));
    }
    for (i = 0; i < 2; i++) state[i] = gx_body_state_hash(c.body[i]);
    ck_assert(state[0] != state[1]);
    let_go(&c);
    let_go(&d);
}
END_TEST

/* A heap falls asleep, and wakes where it is touched or cut. */
START_TEST(bodies_sleep) {
    const body_like like = {0, 0.5, NULL, NULL};
    const gx_collider floor = ground(0.5);
    crowd c = two_blocks(&like, 0.2);
    gx_step_desc steps[2];
    gx_step_report report;
    int n;
    describe_steps(PLAIN, steps, 2);
    steps[0].newton_iterations = 1;
    steps[0].cg_tolerance = 1e-2;
    steps[0].colliders = &floor;
    steps[0].collider_count = 1;
    steps[0].sleep_speed = 0.02;
    for (n = 0; n < 400; n++) {
        report = step_all(&c, steps);
        if (report.stop == GXS_STOP_ASLEEP) break;
    }
    ck_assert_msg(n < 400, "still awake");
    cut_across(c.body[1], 0, 0.55);
    ck_assert_int_ne(step_all(&c, steps).stop, GXS_STOP_ASLEEP);
    for (n = 0; n < 400 && step_all(&c, steps).stop != GXS_STOP_ASLEEP;) n++;
    ck_assert_msg(n < 400, "still awake after the cut");
    view_of(c.body[0]).velocity[0] = 0.5;
    ck_assert_int_ne(step_all(&c, steps).stop, GXS_STOP_ASLEEP);
    let_go(&c);
}
END_TEST

static int none_of_two(void *user, uint32_t fragment, uint32_t other, uint32_t collider) {
    const uint32_t first = *(const uint32_t *)user;
    (void)collider;
    return other == UINT32_MAX || (fragment < first) == (other < first);
}

/* Fragments of the second body follow those of the first one. */
START_TEST(filters_know_all_fragments) {
    const body_like like = {0, 0.3, NULL, NULL};
    crowd c = two_blocks(&like, 0.2);
    gx_step_desc steps[2];
    uint32_t first = 2;
    gx_motion motions[MOST_PIECES];
    int n;
    hold_low(c.body[0], 0.1);
    cut_across(c.body[0], 2, 0.5);
    cut_across(c.body[1], 0, 0.7);
    describe_steps(PLAIN, steps, 2);
    steps[0].contact_filter = none_of_two;
    steps[0].contact_filter_user = &first;
    for (n = 0; n < 40; n++) (void)step_all(&c, steps);
    (void)motions_of(&c.body[1], 1, motions); /* falls through */
    ck_assert_double_eq_tol(motions[0].velocity[2], -9.81 * 40 / 60, 0.1);
    (void)motions_of(c.body, 1, motions); /* the upper half still lies on the lower one */
    ck_assert_double_gt(motions[1].center[2], 0.6);
    let_go(&c);
}
END_TEST

/* Bodies may be stepped alone, emptied and cut between steps of the group. */
START_TEST(bodies_go_their_own_way) {
    const body_like like = {0, 0.3, NULL, NULL};
    crowd c = two_blocks(&like, 0.2);
    workload box = wl_empty();
    gx_step_desc steps[2];
    int n;
    hold_low(c.body[0], 0.1);
    describe_steps(BDF2, steps, 2);
    for (n = 0; n < 30; n++) {
        (void)step_all(&c, steps);
        if (n % 3 == 0) ck_assert_int_eq(gx_body_step(c.body[n % 2], &steps[0], NULL, NULL), GX_OK);
        if (n == 10) cut_across(c.body[1], 1, 0.4);
    }
    (void)add_box(&box, 1, -9, -9, -9, 9, 9, 9);
    (void)cut_by(c.body[1], &box, 0, 1);
    ck_assert_uint_eq(view_of(c.body[1]).fragment_count, 0);
    for (n = 0; n < 5; n++) (void)step_all(&c, steps);
    (void)cut_by(c.body[0], &box, 0, 1);
    ck_assert_int_eq(step_all(&c, steps).stop, GXS_STOP_ASLEEP);
    wl_free(&box);
    let_go(&c);
}
END_TEST

/* A body that becomes another one of other materials has them in the next step. */
START_TEST(materials_come_with_a_restore) {
    const body_like like = {0, 0.3, NULL, NULL};
    crowd c = two_blocks(&like, 0.2), d;
    gx_body_desc desc = desc_of(&c.mesh[1]);
    gx_contact_desc contact;
    gx_body *soft = NULL;
    gx_step_desc steps[2];
    int n;
    memset(&contact, 0, sizeof contact);
    desc.young = 2e4;
    ck_assert_int_eq(gx_body_create(&desc, &soft, NULL), GX_OK);
    ck_assert_int_eq(gx_body_contact(soft, &contact, NULL), GX_OK);
    hold_low(c.body[0], 0.1);
    describe_steps(PLAIN, steps, 2);
    for (n = 0; n < 5; n++) (void)step_all(&c, steps);
    ck_assert_int_eq(gx_body_restore(c.body[1], soft, NULL), GX_OK);
    memset(&d, 0, sizeof d);
    d.count = 2;
    for (n = 0; n < 2; n++) ck_assert_int_eq(gx_body_clone(c.body[n], &d.body[n], NULL), GX_OK);
    gather(&d);
    for (n = 0; n < 20; n++) {
        (void)step_all(&c, steps);
        (void)step_all(&d, steps);
    }
    ck_assert_msg(apart(c.body, 2, d.body, 2) < 1e-5, "%g m apart", apart(c.body, 2, d.body, 2));
    gx_body_destroy(soft);
    let_go(&c);
    let_go(&d);
}
END_TEST

static void expect(gx_result result, gx_result due, const gx_failure *failure, const char *field, size_t surface) {
    ck_assert_int_eq(result, due);
    ck_assert_int_eq(failure->result, due);
    ck_assert_str_eq(failure->field, field);
    ck_assert_uint_eq(failure->surface, surface);
}

START_TEST(refusals) {
    const body_like like = {0, 0.3, NULL, NULL};
    crowd c = two_blocks(&like, 0.2);
    gx_body *twice[2];
    gx_group *group = NULL;
    gx_group_contact contact;
    gx_step_desc steps[2];
    gx_failure f;
    double *forces;
    size_t count, i;
    twice[0] = twice[1] = c.body[0];
    expect(gx_group_create(NULL, 1, &group, &f), GX_ERROR_ARGUMENT, &f, "bodies", SIZE_MAX);
    expect(gx_group_create(c.body, 2, NULL, &f), GX_ERROR_ARGUMENT, &f, "group", SIZE_MAX);
    expect(gx_group_create(c.body, 0, &group, &f), GX_ERROR_EMPTY, &f, "body_count", SIZE_MAX);
    expect(gx_group_create(c.body, 70000, &group, &f), GX_ERROR_LIMIT, &f, "body_count", SIZE_MAX);
    expect(gx_group_create(twice, 2, &group, &f), GX_ERROR_ARGUMENT, &f, "bodies", 1);
    twice[0] = NULL;
    expect(gx_group_create(twice, 2, &group, &f), GX_ERROR_ARGUMENT, &f, "bodies", 0);
    ck_assert_ptr_null(group);
    gx_group_destroy(NULL);
    describe_steps(PLAIN, steps, 2);
    expect(gx_group_step(NULL, steps, NULL, &f), GX_ERROR_ARGUMENT, &f, "group", SIZE_MAX);
    expect(gx_group_step(c.group, NULL, NULL, &f), GX_ERROR_ARGUMENT, &f, "steps", SIZE_MAX);
    steps[0].quality = 0.1;
    expect(gx_group_step(c.group, steps, NULL, &f), GX_ERROR_ARGUMENT, &f, "quality", SIZE_MAX);
    describe_steps(PLAIN, steps, 2);
    steps[0].integrator = GXS_MIDPOINT;
    expect(gx_group_step(c.group, steps, NULL, &f), GX_ERROR_ARGUMENT, &f, "integrator", SIZE_MAX);
    describe_steps(PLAIN, steps, 2);
    steps[1].spring_count = 1;
    expect(gx_group_step(c.group, steps, NULL, &f), GX_ERROR_ARGUMENT, &f, "springs", 1);
    describe_steps(PLAIN, steps, 2);
    count = view_of(c.body[1]).copy_count;
    forces = (double *)calloc(3 * count, sizeof *forces);
    steps[1].forces = forces;
    steps[1].epoch = 77;
    expect(gx_group_step(c.group, steps, NULL, &f), GX_ERROR_STALE, &f, "epoch", 1);
    describe_steps(PLAIN, steps, 2);
    for (i = 0; i < 2; i++) { /* the copy's own number, of its body */
        view_of(c.body[i]).displacement[3 * 5 + 1] = HUGE_VAL;
        expect(gx_group_step(c.group, steps, NULL, &f), GX_ERROR_NOT_FINITE, &f, "displacement", i);
        ck_assert_uint_eq(f.index, 5);
        view_of(c.body[i]).displacement[3 * 5 + 1] = 0;
    }
    expect(gx_group_contacts(NULL, &contact, 1, &count, &f), GX_ERROR_ARGUMENT, &f, "group", SIZE_MAX);
    expect(gx_group_contacts(c.group, &contact, 1, NULL, &f), GX_ERROR_ARGUMENT, &f, "count", SIZE_MAX);
    expect(gx_group_contacts(c.group, NULL, 1, &count, &f), GX_ERROR_ARGUMENT, &f, "contacts", SIZE_MAX);
    ck_assert_int_eq(gx_group_contacts(c.group, &contact, 1, &count, &f), GX_OK);
    ck_assert_uint_eq(count, 0);
    hold_low(c.body[0], 0.1);
    for (i = 0; i < 30; i++) (void)step_all(&c, steps);
    expect(gx_group_contacts(c.group, &contact, 1, &count, &f), GX_ERROR_CAPACITY, &f, "capacity", SIZE_MAX);
    ck_assert_uint_gt(count, 1);
    cut_across(c.body[1], 0, 0.5);
    expect(gx_group_contacts(c.group, &contact, 1, &count, &f), GX_ERROR_SEQUENCE, &f, "gx_group_step", 1);
    ck_assert_int_eq(gx_body_contact(c.body[1], NULL, NULL), GX_OK);
    expect(gx_group_step(c.group, steps, NULL, &f), GX_ERROR_SEQUENCE, &f, "gx_body_contact", 1);
    free(forces);
    let_go(&c);
}
END_TEST

/* Without memory all bodies stay as they were, and a later step succeeds. */
START_TEST(without_memory) {
    memory m = plenty();
    const gx_allocator scarce = allocator_of(&m);
    body_like like = {0, 0.3, NULL, NULL};
    crowd c;
    gx_step_desc steps[2];
    gx_result result = GX_ERROR_MEMORY;
    size_t n, i;
    like.affine_below = _i == 1 ? 1 : 0;
    like.allocator = &scarce;
    c = two_blocks(&like, 0.2);
    gx_group_destroy(c.group);
    c.group = NULL;
    for (n = 0; result != GX_OK; n++) {
        fail_from(&m, n, 0);
        result = gx_group_create(c.body, 2, &c.group, NULL);
        never_fail(&m);
        ck_assert(result == GX_OK || result == GX_ERROR_MEMORY);
    }
    ck_assert_uint_gt(n, 3);
    hold_low(c.body[0], 0.1);
    describe_steps(_i == 2 ? BDF2 : PLAIN, steps, 2);
    for (i = 0; i < 12; i++) {
        if (i == 10) cut_across(c.body[1], 2, 1.1);
        result = i % 10 == 0 ? GX_ERROR_MEMORY : GX_OK;
        if (result == GX_OK) (void)step_all(&c, steps);
        for (n = 0; result != GX_OK; n++) {
            const uint64_t state[2] = {gx_body_state_hash(c.body[0]), gx_body_state_hash(c.body[1])};
            ck_assert_uint_lt(n, 10000);
            fail_from(&m, n, _i % 2);
            result = gx_group_step(c.group, steps, NULL, NULL);
            never_fail(&m);
            ck_assert(result == GX_OK || (result == GX_ERROR_MEMORY && state[0] == gx_body_state_hash(c.body[0]) &&
                                          state[1] == gx_body_state_hash(c.body[1])));
        }
    }
    let_go(&c);
    ck_assert(is_whole(&m));
    release_all(&m);
}
END_TEST

/* Events name bodies and fragments, as they begin, go on and end. */
START_TEST(events_name_bodies) {
    const body_like like = {0, 0.3, NULL, NULL};
    const gx_collider floor = ground(0.5);
    crowd c = two_blocks(&like, 0.2);
    gx_step_desc steps[2];
    gx_group_contact_event events[16];
    gx_failure f;
    size_t count, i, k, began = 0, with_floor = 0;
    double sum = 0;
    int n;
    describe_steps(PLAIN, steps, 2);
    steps[0].colliders = &floor;
    steps[0].collider_count = 1;
    ck_assert_int_eq(gx_group_contact_events(c.group, events, 16, &count, NULL), GX_OK);
    ck_assert_uint_eq(count, 0);
    for (n = 0; n < 120; n++) {
        (void)step_all(&c, steps);
        ck_assert_int_eq(gx_group_contact_events(c.group, events, 16, &count, NULL), GX_OK);
        for (i = 0; i < count; i++) {
            const gx_group_contact_event *e = &events[i];
            ck_assert_uint_lt(e->body, 2);
            ck_assert_uint_eq(e->event.fragment, 1); /* each body's first */
            if (e->event.collider != UINT32_MAX) {
                ck_assert_uint_eq(e->other_body, UINT32_MAX);
                ck_assert_uint_eq(e->event.other, 0);
                ck_assert_uint_eq(e->body, 0);
                with_floor++;
                continue;
            }
            ck_assert(e->body == 0 && e->other_body == 1 && e->event.other == 1);
            began += e->event.change == GX_CONTACT_BEGAN;
            sum += n < 60 ? 0 : e->event.force[2] / 60;
        }
    }
    ck_assert_uint_ge(began, 1);
    ck_assert_uint_gt(with_floor, 10);
    ck_assert_msg(fabs(sum + 9.81 * 1000) < 500, "%g N on the lower one", sum);
    expect(gx_group_contact_events(NULL, events, 16, &count, &f), GX_ERROR_ARGUMENT, &f, "group", SIZE_MAX);
    expect(gx_group_contact_events(c.group, NULL, 16, &count, &f), GX_ERROR_ARGUMENT, &f, "events", SIZE_MAX);
    expect(gx_group_contact_events(c.group, events, 16, NULL, &f), GX_ERROR_ARGUMENT, &f, "count", SIZE_MAX);
    expect(gx_group_contact_events(c.group, events, 1, &count, &f), GX_ERROR_CAPACITY, &f, "capacity", SIZE_MAX);
    cut_across(c.body[1], 0, 0.7);
    expect(gx_group_contact_events(c.group, events, 16, &count, &f), GX_ERROR_SEQUENCE, &f, "gx_group_step", 1);
    (void)step_all(&c, steps);
    expect(gx_group_contact_events(c.group, events, 16, &count, &f), GX_ERROR_SEQUENCE, &f, "gx_body_view", 1);
    (void)view_of(c.body[1]);
    c.body[0]->snapshot.next_id += UINT32_MAX / 2; /* as if so many had been */
    ck_assert_int_eq(gx_group_contact_events(c.group, events, 16, &count, &f), GX_ERROR_LIMIT);
    ck_assert_uint_eq(f.surface, 0);
    c.body[0]->snapshot.next_id -= UINT32_MAX / 2;
    ck_assert_int_eq(gx_group_contact_events(c.group, events, 16, &count, NULL), GX_OK);
    for (i = k = 0; i < count; i++)
        k += events[i].body == 0 && events[i].event.other == 2 && events[i].event.change == GX_CONTACT_BEGAN;
    ck_assert_uint_eq(k, 1); /* the new piece of the second body lies on the first one */
    let_go(&c);
}
END_TEST

/* The same bits with threads of the host's, which the group takes from its first body, and with tasks in any order */
START_TEST(threads_do_not_matter) {
    uint64_t states[4], order = 5;
    int i, n;
    for (i = 0; i < 4; i++) {
        pool threads;
        gx_jobs jobs;
        body_like like = {0, 0.3, NULL, NULL};
        crowd c;
        gx_step_desc steps[2];
        jobs.parallel_for = i == 3 ? shuffled_for : pool_for;
        jobs.user = i == 3 ? (void *)&order : (void *)&threads;
        if (i == 1 || i == 2) pool_open(&threads, (size_t)i + 1);
        if (i > 0) like.jobs = &jobs;
        c = two_blocks(&like, 0.2);
        hold_low(c.body[0], 0.1);
        describe_steps(PLAIN, steps, 2);
        for (n = 0; n < 20; n++) {
            if (n == 10) cut_across(c.body[1], 0, 0.7);
            (void)step_all(&c, steps);
        }
        states[i] = gx_body_state_hash(c.body[0]) ^ 3 * gx_body_state_hash(c.body[1]);
        ck_assert(states[i] == states[0]);
        let_go(&c);
        if (i == 1 || i == 2) pool_close(&threads);
    }
}
END_TEST

static Suite *suite(void) {
    Suite *s = suite_create("group");
    TCase *tests = tcase_create("group");
    tcase_set_timeout(tests, 300);
    tcase_add_loop_test(tests, one_is_as_alone, 0, KINDS);
    tcase_add_loop_test(tests, two_are_as_one, 0, AFFINE);
    tcase_add_loop_test(tests, loads_are_the_bodies_own, 0, 2);
    tcase_add_test(tests, momentum_stays);
    tcase_add_loop_test(tests, goes_on_after_saving, 0, 4);
    tcase_add_test(tests, bodies_sleep);
    tcase_add_test(tests, filters_know_all_fragments);
    tcase_add_test(tests, bodies_go_their_own_way);
    tcase_add_test(tests, materials_come_with_a_restore);
    tcase_add_test(tests, events_name_bodies);
    tcase_add_test(tests, threads_do_not_matter);
    tcase_add_test(tests, refusals);
    tcase_add_loop_test(tests, without_memory, 0, 3);
    suite_add_tcase(s, tests);
    return s;
}

int main(void) { return run_suite(suite()); }
