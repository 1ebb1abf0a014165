/* surgeon: a liver-like body, held at its back, sags under its weight. A blade slices it, then excises a wedge by two
   strokes that meet, and a spring pulls the wedge off.

   All is given in space, where the body is when the blade comes: the strokes start from the box of its deformed
   surface, and the spring takes hold where a ray from the front meets it. The blade is a bowed line that stands
   upright. Each stroke goes from the front, y small, to the back. The two strokes of the wedge cross near their ends,
   in the body, where the blade is lifted. */
#include "scene.h"

enum { EDGE = 6 /* parts of the blade's edge */ };
enum { SLICE, FIRST, SECOND, STROKES };

/* A stroke, seen from above: the blade goes straight from one point to another, between two heights. Its middle is
   ahead. */
typedef struct stroke {
    double from[2], to[2], low, high, bow; /* m */
} stroke;

static void stroke_point(const void *user, double a, double b, double *at) {
    const stroke *path = (const stroke *)user;
    const double d[2] = {path->to[0] - path->from[0], path->to[1] - path->from[1]};
    const double ahead = path->bow * 4.0 * b * (1.0 - b) / sqrt(d[0] * d[0] + d[1] * d[1]);
    at[0] = path->from[0] + (a + ahead) * d[0];
    at[1] = path->from[1] + (a + ahead) * d[1];
    at[2] = path->low + b * (path->high - path->low);
}

/* A ball of radius 1 becomes a liver of 0.26 m: thick at the right (x < 0), thin at the left, hollow below. */
static void shape_liver(scene *s) {
    size_t i;
    for (i = 0; i < s->mesh.node_count; i++) {
        double *at = s->mesh.positions + 3 * i;
        const double x = at[0], y = at[1], z = at[2];
        at[0] = 0.13 * x;
        at[1] = 0.09 * (1.0 - 0.25 * x) * y + 0.02 * x * x;
        at[2] = 0.045 * (1.0 - 0.4 * x) * z - 0.02 * x * x - 0.015 * y * y;
    }
}

static const double wedge_tip[2] = {-0.045, -0.01}; /* m */

/* From the front to the back: one that slices the left lobe off, two that cross at the tip of a wedge */
static void plan_strokes(const double low[3], const double high[3], stroke strokes[STROKES]) {
    const double front = low[1] - 0.03, past = 0.25, start[2] = {-0.1, 0.01};
    int i, k;
    for (i = 0; i < STROKES; i++) {
        stroke *path = &strokes[i];
        path->low = low[2] - 0.05;
        path->high = high[2] + 0.05;
        path->bow = 0.012;
        path->from[0] = i == SLICE ? 0.05 : start[i - FIRST];
        path->from[1] = front;
        path->to[0] = 0.07;
        path->to[1] = high[1] + 0.03;
        for (k = 0; k < 2 && i != SLICE; k++) path->to[k] = wedge_tip[k] + past * (wedge_tip[k] - path->from[k]);
    }
}

/* Takes hold of the body where a ray along y from the front meets it. */
static gx_anchor grasp(scene *s, double x, double z, gxs_spring *spring) {
    const double eye[3] = {x, -1.0, z}, ahead[3] = {0, 1, 0};
    gx_anchor anchor;
    gx_hit hit;
    scene_must(s, gx_body_pick(s->body, eye, ahead, &hit, &s->failure), "pick");
    scene_must(s, gx_hit_anchor(s->body, &hit, &anchor, &s->failure), "spring");
    memset(spring, 0, sizeof *spring);
    memcpy(spring->target, hit.position, sizeof spring->target);
    spring->stiffness = 500.0;
    return anchor;
}

/* The fragment that an anchor is in */
static uint32_t anchored_fragment(scene *s, const gx_anchor *anchor) {
    uint32_t *fragments = scene_copy_fragments(s), fragment;
    gxs_point point;
    scene_must(s, gx_body_anchor_point(s->body, anchor, &point, NULL, &s->failure), "spring");
    fragment = fragments[point.copy[0]];
    free(fragments);
    return fragment;
}

/* Copies of a fragment that are held */
static size_t held_copies(scene *s, uint32_t fragment) {
    uint32_t *fragments = scene_copy_fragments(s);
    size_t i, count = 0;
    for (i = 0; i < s->view.copy_count; i++) count += s->view.copy_held[i] && fragments[i] == fragment;
    free(fragments);
    return count;
}

static double distance(const double a[3], const double b[3]) {
    return sqrt(pow(a[0] - b[0], 2.0) + pow(a[1] - b[1], 2.0) + pow(a[2] - b[2], 2.0));
}

static void check_wedge(scene *s, uint32_t wedge, const double before[3], const double target[3]) {
    const double share = s->view.fragment_volume[wedge] / s->view.volume;
    const gx_motion motion = scene_motion(s, wedge);
    uint32_t f;
    scene_check(s, share > 0.04 && share < 0.16, "the wedge: %.1f %% of the body (4 %% to 16 %%)", 100.0 * share);
    scene_check(s, distance(motion.center, before) > 0.1, "pulled off by %.3f m (more than 0.1 m)",
                distance(motion.center, before));
    scene_check(s, distance(motion.center, target) < 0.06, "its centre is %.3f m from where the spring pulls (0.06 m)",
                distance(motion.center, target));
    for (f = 0; f < s->view.fragment_count; f++)
        scene_check(s, (held_copies(s, f) == 0) == (f == wedge), "held copies of fragment %lu: %lu (none of the wedge)",
                    (unsigned long)f + 1, (unsigned long)held_copies(s, f));
}

typedef struct surgery {
    stroke strokes[STROKES];
    size_t fragments[STROKES]; /* after each stroke; 0: it is not over */
    gxs_spring spring;
    gx_anchor anchor;          /* of the spring, in the wedge */
    double grip[3], center[3]; /* in space: where the spring took hold, the wedge's centre before it is pulled */
} surgery;

/* Shares of the run */
static const double from[STROKES] = {0.05, 0.25, 0.42}, to[STROKES] = {0.2, 0.38, 0.55}, pull_from = 0.6, pull_to = 0.9;

/* Held at its back, at rest under its weight; plans the strokes by the box of what is then to be seen. */
static void lay_down(scene *s, surgery *on) {
    double low[3], high[3], bottom;
    scene_hold(s, 1, 1, 0.06);
    scene_look(s);
    gxio_bounds(s->skin.positions, s->skin.triangles.vertex_count, low, high);
    bottom = low[2];
    scene_settle(s, 1e-6);
    gxio_bounds(s->skin.positions, s->skin.triangles.vertex_count, low, high);
    scene_check(s, bottom - low[2] > 0.02, "sags by %.3f m (more than 0.02 m)", bottom - low[2]);
    plan_strokes(low, high, on->strokes);
}

/* The spring takes hold between the strokes of the wedge, and moves when both are over. */
static void pull(scene *s, surgery *on) {
    const double share = scene_share(s, s->frame, pull_from, pull_to), way[3] = {0, -0.12, 0.08};
    int i;
    if (on->fragments[FIRST] == 0) return;
    if (s->step.spring_count == 0) {
        on->anchor = grasp(s, wedge_tip[0], 0.5 * (on->strokes[FIRST].low + on->strokes[FIRST].high), &on->spring);
        memcpy(on->grip, on->spring.target, sizeof on->grip);
        s->step.springs = &on->spring;
        s->step.spring_anchors = &on->anchor;
        s->step.spring_count = 1;
    }
    if (on->fragments[SECOND] > 0 && share <= 0.0)
        memcpy(on->center, scene_motion(s, anchored_fragment(s, &on->anchor)).center, sizeof on->center);
    for (i = 0; i < 3; i++) on->spring.target[i] = on->grip[i] + share * way[i];
}

/* A frame of the surgery */
static void operate(scene *s, scene_blade *blade, surgery *on) {
    int i;
    for (i = 0; i < STROKES; i++) {
        if (on->fragments[i] == 0 && scene_share(s, s->frame - 1.0, from[i], to[i]) >= 1.0)
            on->fragments[i] = s->view.fragment_count;
        scene_stroke(s, blade, stroke_point, &on->strokes[i], EDGE, from[i], to[i]);
    }
    pull(s, on);
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "surgeon",
                             .about = "A liver is sliced, then a wedge of it is excised and pulled off.",
                             .mesh = "ball:1,0.14",
                             .small_mesh = "ball:1,0.24",
                             .frames = 240,
                             .small_frames = 120,
                             .least_frames = 60};
    static const char *const names[STROKES] = {"slice", "first side of the wedge", "second side"};
    static const size_t expected[STROKES] = {2, 2, 3};
    scene s;
    scene_blade blade;
    surgery on;
    int i;
    memset(&on, 0, sizeof on);
    scene_open(&s, &desc, argc, argv);
    shape_liver(&s);
    s.body_desc.young = 2e4;
    s.body_desc.poisson = 0.45;
    s.step.dt = 4.0 / s.frames;
    s.step.mass_damping = 1.0;
    scene_make(&s);
    lay_down(&s, &on);
    blade = scene_make_blade(&s, NULL);
    for (; s.frame < s.frames; scene_step(&s)) operate(&s, &blade, &on);
    for (i = 0; i < STROKES; i++)
        scene_check(&s, on.fragments[i] == expected[i], "fragments after the %s: %lu (%lu)", names[i],
                    (unsigned long)on.fragments[i], (unsigned long)expected[i]);
    scene_check(&s, s.view.fragment_count == 3, "fragments in the end: %lu (3)", (unsigned long)s.view.fragment_count);
    check_wedge(&s, anchored_fragment(&s, &on.anchor), on.center, on.spring.target);
    scene_say(&s, "the cuts are off the blade's path by %.1e m at most, the smallest link is %.1e of its face",
              blade.deviation, blade.min_link_ratio);
    scene_check_whole(&s);
    return scene_close(&s);
}
