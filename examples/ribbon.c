/* ribbon: the head of an octopus is peeled into a spiral ribbon thinner than an element, which hangs from it.

   The octopus is held by its arms, head down. The blade is an L: one side goes from outside to the depth of the peel,
   the other one from there down, to beyond the turn before. It winds up around the head, as one peels an apple; where
   it begins, a plane has cut the lowest part off from inside. The ribbon bends by its thickness, since copies carry an
   affine motion where material is thin (gx_body_desc.affine_below). In the end the same cuts are made in a body without
   them. */
#include "scene.h"

static const double pi = 3.14159265358979323846;
/* m: the head as gxshape_octopus makes it, an ellipsoid that points to -z; what is above is held */
static const double center[3] = {0.005, -0.065, -0.075}, radius[3] = {0.095, 0.095, 0.110}, held = -0.08;
static const double first = 0.25, last = 1.22; /* rad from the lowest point: where the blade begins and ends */

/* What the blade follows: the depth of the peel, a share of the head's radius */
typedef struct peel {
    double depth;
    uint32_t turns;
} peel;

static void head_point(double polar, double turn, double share, double *x) {
    x[0] = center[0] + share * radius[0] * sin(polar) * cos(turn);
    x[1] = center[1] + share * radius[1] * sin(polar) * sin(turn);
    x[2] = center[2] - share * radius[2] * cos(polar);
}

/* a: upwards; b: inwards, then down by a little more than a turn, less deep there, so that it crosses the wall of the
 * turn before */
static void blade_point(const void *user, double a, double b, double *x) {
    const peel *p = (const peel *)user;
    const double down = fmax(0.0, 1.5 * b - 0.5), polar = first + (last - first) * (a - 1.05 * down / p->turns);
    head_point(fmax(polar, 0.4 * first), 2.0 * pi * p->turns * a,
               b > 0.0 ? 1.0 - (1.0 - 0.1 * down) * p->depth : 1.0 + p->depth, x);
}

/* A plane across the lowest point, which the blade does not reach: below the blade's first column, and up to where it
 * is above the others */
static void cut_lowest(scene *s, const peel *p) {
    const double share = (1.0 - 1.1 * p->depth) * cos(first), most = 1.0 - 0.6 * p->depth;
    const double half = most * sin(acos(share / most)) * radius[0];
    const double corner[3] = {center[0] - half, center[1] - half, center[2] - share * radius[2]};
    scene_cut_flat(s, corner, (double[3]){2.0 * half, 0, 0}, (double[3]){0, 2.0 * half, 0});
}

/* The lowest point of the head, which the ribbon ends with; of a body at rest */
static gx_anchor mark_end(scene *s, gx_body *body) {
    const double below[3] = {center[0], center[1], center[2] - 2.0 * radius[2]}, up[3] = {0, 0, 1};
    gx_anchor end;
    gx_skin skin;
    gx_hit hit;
    scene_must(s, gx_body_skin(body, NULL, &skin, &s->failure), "skin");
    scene_must(s, gx_body_pick(body, below, up, &hit, &s->failure), "end");
    scene_must(s, gx_hit_anchor(body, &hit, &end, &s->failure), "end");
    return end;
}

static double height(scene *s, gx_body *body, const gx_anchor *end) {
    double x[3];
    scene_must(s, gx_body_anchor_point(body, end, NULL, x, &s->failure), "end");
    return x[2];
}

/* How high the end is at rest if the same cuts are made without affine copies, m */
static double height_of_linear(scene *s) {
    gx_body_desc desc = s->body_desc;
    gx_step_desc step = s->step;
    gx_cut_desc cut;
    gx_body *body;
    gx_anchor end;
    double z;
    memset(&cut, 0, sizeof cut);
    memset(&desc.allocator, 0, sizeof desc.allocator);
    desc.affine_below = 0.0;
    cut.surfaces = s->cuts;
    cut.surface_count = s->cut_count;
    step.integrator = GXS_STATIC;
    step.dt = 0.0;
    step.newton_iterations = 1000;
    step.newton_tolerance = 1e-6;
    scene_must(s, gx_body_create(&desc, &body, &s->failure), "body");
    scene_must(s, gx_body_hold(body, s->regions, s->region_count, &s->failure), "hold");
    end = mark_end(s, body);
    scene_must(s, gx_body_cut(body, &cut, NULL, &s->failure), "cut");
    scene_must(s, gx_body_step(body, &step, NULL, &s->failure), "rest");
    z = height(s, body, &end);
    gx_body_destroy(body);
    return z;
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "ribbon",
                             .about = "An octopus's head is peeled into a spiral ribbon thinner than an element.",
                             .mesh = "octopus",
                             .small_mesh = "octopus:0.026",
                             .frames = 96,
                             .small_frames = 24,
                             .least_frames = 20};
    double before, linear, mean = 0.0, stretch;
    uint32_t counted = 0;
    gx_anchor end;
    scene_sheet blade;
    scene s;
    peel p;
    scene_open(&s, &desc, argc, argv);
    p.turns = s.small ? 2 : 3;
    p.depth = 0.4 * (s.small ? 0.026 : 0.0188) / radius[0];
    s.body_desc.young = s.small ? 1e6 : 4e6; /* Pa; the longer ribbon is heavier and bends farther */
    s.body_desc.affine_below = 1.0;
    s.step.dt = 1.0 / 60.0;
    s.step.newton_iterations = 0;
    scene_make(&s);
    scene_hold(&s, 2, 1, held);
    end = mark_end(&s, s.body);
    scene_settle(&s, 1e-6);
    before = height(&s, s.body, &end);
    cut_lowest(&s, &p);
    blade = scene_make_sheet(&s, 40 * p.turns, 3, blade_point, &p);
    while (s.frame < s.frames) {
        scene_advance(&s, &blade, 0.0, 0.4);
        scene_step(&s);
        if (3 * s.frame <= 2 * s.frames) continue;
        mean += height(&s, s.body, &end);
        counted++;
    }
    mean /= counted;
    linear = height_of_linear(&s);
    stretch = scene_largest_stretch(&s);
    scene_check(
        &s, before - linear <= 0.5 * (before - mean) && before - mean > 0.05,
        "end of the ribbon in the last third: %.4f m down in the mean; without affine copies: %.4f m (at most half)",
        before - mean, before - linear);
    scene_check(&s, stretch < 2.0, "largest stretch: %.2f (below 2: nothing drifts away)", stretch);
    scene_check(&s, s.view.fragment_count == 1, "fragments: %lu (1)", (unsigned long)s.view.fragment_count);
    scene_check_body(&s);
    scene_drop_sheet(&blade);
    return scene_close(&s);
}
