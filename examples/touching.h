/* touching.h: what the scenes have in common that end in contact (pile, lips, sausage): the ground, how deep pieces are
   in each other by gxoverlap.h, which shares nothing with contact, and the checks of bodies that come to rest. */
#ifndef TOUCHING_H
#define TOUCHING_H

#include "gxoverlap.h"

/* Depths are looked at in every so many frames: it takes longer than a step. */
enum { TOUCHING_EVERY = 5 };

typedef struct touching {
    double friction, size; /* size: mean edge of the mesh's elements, m */
    double height;         /* of the ground, m */
    gx_collider ground;
    double flight, rest; /* m: the deepest overlap so far, and in the end */
} touching;

/* Switches contact on, before gravity acts. Without ground if its height is -HUGE_VAL. */
static inline void touching_begin(scene *s, touching *on, double friction, double height) {
    gx_contact_desc contact;
    int k;
    memset(on, 0, sizeof *on);
    memset(&contact, 0, sizeof contact);
    on->friction = contact.friction = friction;
    on->height = height;
    on->size = cbrt(6.0 * sqrt(2.0) * scene_mesh_volume(s) / (double)s->mesh.element_count);
    scene_must(s, gx_body_contact(s->body, &contact, &s->failure), "contact");
    if (height == -HUGE_VAL) return;
    on->ground.kind = GX_COLLIDER_PLANE;
    for (k = 0; k < 3; k++) on->ground.pose[5 * k] = 1.0;
    on->ground.pose[11] = height;
    on->ground.friction = friction;
    s->step.colliders = &on->ground;
    s->step.collider_count = 1;
}

/* How deep pieces are in each other, or the only one in itself, and in the ground, within a tolerance, m */
static inline double touching_depth(scene *s, const touching *on, double tolerance) {
    gxoverlap_surface surface;
    gxoverlap_forest forest;
    double depth;
    surface.positions = s->skin.positions;
    surface.triangles = s->skin.triangles.triangles;
    surface.pieces = s->skin.triangles.fragment;
    surface.triangle_count = s->skin.triangles.triangle_count;
    if (!gxoverlap_make(&forest, &surface)) scene_misuse(s, "overlap", "no memory");
    depth =
        s->view.fragment_count > 1 ? gxoverlap_of_pieces(&forest, tolerance).depth : gxoverlap_of_itself(&forest).depth;
    gxoverlap_release(&forest);
    return fmax(depth, gxoverlap_in_convex(&surface, gxoverlap_from_ground, &on->height, tolerance).depth);
}

/* After a frame */
static inline void touching_look(scene *s, touching *on) {
    if (s->frame % TOUCHING_EVERY == 0) on->flight = fmax(on->flight, touching_depth(s, on, 0.02 * on->size));
}

/* The lowest of the centres of all fragments, m */
static inline double touching_lowest(scene *s) {
    double lowest = HUGE_VAL;
    uint32_t f;
    for (f = 0; f < s->view.fragment_count; f++) lowest = fmin(lowest, scene_motion(s, f).center[2]);
    return lowest;
}

/* Depths on the way and in the end, in elements, with bounds of both */
static inline void touching_check_depths(scene *s, touching *on, double flight, double rest) {
    on->rest = touching_depth(s, on, 0.002 * on->size);
    scene_check(s, on->flight <= flight * on->size,
                "deepest overlap on the way, every %d frames: %.4f of an element (at most %.3g)", TOUCHING_EVERY,
                on->flight / on->size, flight);
    scene_check(s, on->rest <= rest * on->size, "overlap in the end: %.4f of an element (at most %.3g)",
                on->rest / on->size, rest);
}

static inline void touching_check_above(scene *s, const touching *on) {
    scene_check(s, touching_lowest(s) > on->height, "the lowest piece's centre is %.4f m above the ground (above 0)",
                touching_lowest(s) - on->height);
}

static inline void touching_check_rest(scene *s, const touching *on) {
    scene_check(s, s->report.stop == GXS_STOP_ASLEEP, "the last step: %s (asleep)",
                s->report.stop == GXS_STOP_ASLEEP ? "asleep" : "awake");
    touching_check_above(s, on);
}

#endif /* TOUCHING_H */
