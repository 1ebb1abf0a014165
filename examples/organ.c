/* organ: a liver of three materials, made from closed surfaces. A tumour is peeled out whole along its interface and
   pulled off; then a slice goes through flesh and vessel.

   The body is all that the surfaces wind around, carved out of a grid: flesh, a stiffer vessel in it, and a tumour at
   the front that stands out a little. No wall lies between them before the tumour is released. */
#include "organ.h"

typedef struct operation {
    double whole[MATERIALS]; /* m3, before any cut */
    double center[3];        /* of the tumour when it is released, in space, m */
    gx_anchor anchor;
    gxs_spring spring;
    int released, sliced;
} operation;

/* Shares of the run */
static const double release_at = 0.15, pull_to = 0.6, slice_at = 0.7;

/* A spring at the tumour's middle */
static void take_hold(scene *s, operation *on) {
    gx_hit hit;
    size_t hits;
    const uint32_t tumour = organ_fragment(s, TUMOUR);
    memcpy(on->center, scene_motion(s, tumour).center, sizeof on->center);
    scene_must(s, gx_body_locate_all(s->body, on->center, &hit, 1, &hits, &s->failure), "locate");
    scene_must(s, gx_hit_anchor(s->body, &hit, &on->anchor, &s->failure), "spring");
    on->spring.stiffness = 200.0;
    s->step.springs = &on->spring;
    s->step.spring_anchors = &on->anchor;
    s->step.spring_count = 1;
}

/* A frame of the operation */
static void operate(scene *s, operation *on) {
    const double way[3] = {-0.02, -0.1, 0.08}, share = scene_share(s, s->frame, release_at, pull_to);
    int k;
    if (!on->released && share > 0.0) {
        scene_peel(s, TUMOUR);
        scene_look(s);
        on->released = 1;
        take_hold(s, on);
    }
    for (k = 0; k < 3; k++) on->spring.target[k] = on->center[k] + share * way[k];
    if (!on->sliced && scene_due(s, slice_at - 0.01, slice_at, 1)) {
        scene_cut_across(s, 0, 0.0417);
        on->sliced = 1;
    }
}

static void check_materials(scene *s, const operation *on, const gxio_surface surfaces[MATERIALS]) {
    static const char *const names[MATERIALS] = {"flesh", "vessel", "tumour"};
    double volume[MATERIALS];
    int m;
    organ_measure(s, UINT32_MAX, volume);
    for (m = 0; m < MATERIALS; m++) {
        const double inside = scene_volume_inside(&surfaces[m]);
        if (m != FLESH)
            scene_check(s, fabs(on->whole[m] / inside - 1.0) <= 1e-12,
                        "volume of the %s against its surface's: %.1e (at most 1e-12)", names[m],
                        fabs(on->whole[m] / inside - 1.0));
        scene_check(s, fabs(volume[m] / on->whole[m] - 1.0) <= 1e-12,
                    "volume of the %s in the end: %.1e off (at most 1e-12)", names[m],
                    fabs(volume[m] / on->whole[m] - 1.0));
    }
}

static void check_pieces(scene *s, const operation *on) {
    const uint32_t tumour = organ_fragment(s, TUMOUR);
    const gx_motion motion = scene_motion(s, tumour);
    double volume[MATERIALS], moved = 0.0;
    uint32_t f;
    int k;
    scene_check(s, s->view.fragment_count == 3, "fragments in the end: %lu (3)", (unsigned long)s->view.fragment_count);
    for (f = 0; f < s->view.fragment_count; f++) {
        organ_measure(s, f, volume);
        scene_check(s,
                    (f == tumour) == (volume[TUMOUR] > 0.0) && (f != tumour) == (volume[FLESH] > 0.0) &&
                        (f != tumour) == (volume[VESSEL] > 0.0),
                    "fragment %lu: flesh %.2e, vessel %.2e, tumour %.2e m3 (the tumour alone, the others without it)",
                    (unsigned long)f + 1, volume[FLESH], volume[VESSEL], volume[TUMOUR]);
    }
    for (k = 0; k < 3; k++) moved += pow(motion.center[k] - on->center[k], 2.0);
    scene_check(s, sqrt(moved) > 0.09, "the tumour is pulled off by %.3f m (more than 0.09 m)", sqrt(moved));
}

int main(int argc, char **argv) {
    const scene_desc desc = {
        .name = "organ",
        .about =
            "A liver of three materials: a tumour is peeled out along its interface, then flesh and vessel are sliced.",
        .frames = 120,
        .small_frames = 40,
        .least_frames = 20};
    gxio_surface surfaces[MATERIALS];
    operation on;
    double mass;
    scene s;
    int m;
    memset(&on, 0, sizeof on);
    scene_open(&s, &desc, argc, argv);
    organ_surfaces(&s, surfaces);
    s.step.dt = 3.0 / s.frames;
    s.step.mass_damping = 1.0;
    organ_make(&s, surfaces, s.small ? 10 : 20);
    scene_hold(&s, 1, 1, 0.05);
    scene_look(&s);
    organ_measure(&s, UINT32_MAX, on.whole);
    mass = scene_mass(&s);
    scene_settle(&s, 1e-6);
    for (; s.frame < s.frames; scene_step(&s)) operate(&s, &on);
    check_materials(&s, &on, surfaces);
    check_pieces(&s, &on);
    mass = fabs(scene_mass(&s) / mass - 1.0);
    scene_check(&s, mass <= 1e-12, "mass against the uncut body's: %.1e (at most 1e-12)", mass);
    scene_check(&s, scene_open_edges(&s) == 0, "open edges of the surface: %lu (0)",
                (unsigned long)scene_open_edges(&s));
    for (m = 0; m < MATERIALS; m++) gxio_surface_release(&surfaces[m]);
    return scene_close(&s);
}
