/* intrinsics.c - what intrinsics cost beside the compiler's own extensions, and what either gives beside plain C.

   make bench-intrinsics builds this three times by -O2 and runs intrinsics.sh, which takes them in turn.
   usage: intrinsics WORKLOAD. It prints milliseconds of the processor, and a hash of the topology that came of it.

       step     30 steps of a block of 8640 elements, which cuts have made a zigzag, that swings
       contact  20 steps of a block of 2560 elements in 64 pieces that press on each other and on the ground
       cut      nine planes through a block of 8640 elements
       boolean  125 turned cubes united; a cube less a wavy slab of 1760 triangles */
#define _POSIX_C_SOURCE 200112L
#define BENCH           "intrinsics"
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "../tests/operand.h"
#include "../tests/workloads.h"
#include "block.h"
#include "clock.h"
#include "expect.h"
#include <stdio.h>

static gx_body *block(uint32_t cells, int cut, double young) {
    block_desc desc;
    gx_body *body = NULL;
    memset(&desc, 0, sizeof desc);
    desc.cells = cells;
    desc.jitter = 0.2;
    desc.young = young;
    desc.cut = cut;
    expect(block_create(&desc, &body) == GX_OK, "no block");
    return body;
}

/* Milliseconds; the body's hash */
static double end(gx_body *body, double start, uint64_t *hash) {
    const double ms = 1e3 * (processor_seconds(NULL) - start);
    *hash = gx_body_topology_hash(body, NULL);
    gx_body_destroy(body);
    return ms;
}

static double steps(uint64_t *hash) {
    gx_body *body = block(12, BLOCK_ACCORDION, 1e6);
    const double start = processor_seconds(NULL);
    gx_step_desc step;
    int i;
    memset(&step, 0, sizeof step);
    step.dt = 0.033;
    step.gravity[2] = -9.81;
    for (i = 0; i < 30; i++) {
        step.gravity[0] = 2 * sin(0.2 * i);
        expect(gx_body_step(body, &step, NULL, NULL) == GX_OK, "no step");
    }
    return end(body, start, hash);
}

static double contacts(uint64_t *hash) {
    gx_body *body = block(8, BLOCK_LOOSE, 1e5);
    gx_contact_desc contact;
    gx_step_desc step;
    gx_collider ground;
    double start;
    int i;
    memset(&contact, 0, sizeof contact);
    memset(&step, 0, sizeof step);
    memset(&ground, 0, sizeof ground);
    contact.friction = ground.friction = 0.5;
    expect(gx_body_contact(body, &contact, NULL) == GX_OK, "no contact");
    ground.kind = GX_COLLIDER_PLANE;
    ground.pose[0] = ground.pose[5] = ground.pose[10] = 1;
    ground.pose[11] = -0.05;
    step.dt = 1.0 / 60;
    step.gravity[2] = -9.81;
    step.colliders = &ground;
    step.collider_count = 1;
    start = processor_seconds(NULL);
    for (i = 0; i < 20; i++) expect(gx_body_step(body, &step, NULL, NULL) == GX_OK, "no step");
    return end(body, start, hash);
}

static double cuts(uint64_t *hash) {
    gx_body *body = block(12, BLOCK_UNCUT, 1e5);
    block_desc desc;
    const double start = processor_seconds(NULL);
    memset(&desc, 0, sizeof desc);
    desc.cells = 12;
    desc.cut = BLOCK_LOOSE;
    expect(block_cut(body, &desc) == GX_OK, "no cut");
    return end(body, start, hash);
}

/* Milliseconds; adds to the hash (FNV-1a) */
static double boolean(const wl_surface *surfaces, size_t count, int operation, uint64_t *hash) {
    const double start = processor_seconds(NULL);
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    double ms;
    size_t i;
    expect(gxb_boolean_create(NULL, &b, NULL) == GX_OK, "no Boolean");
    for (i = 0; i < count; i++) {
        const wl_surface *from = surfaces + i;
        const gxb_operand o = operand_from(from->vertices, from->vertex_count, from->triangles, from->triangle_count,
                                           i == 0 ? GXB_UNION : (uint32_t)operation);
        expect(gxb_boolean_add(b, &o, NULL) == GX_OK, "no operand");
    }
    expect(gxb_boolean_evaluate(b, &r, NULL) == GX_OK, "no result");
    ms = 1e3 * (processor_seconds(NULL) - start);
    for (i = 0; i < 3 * r.triangle_count; i++) *hash = (*hash ^ r.triangles[i]) * 1099511628211u;
    gxb_boolean_destroy(b);
    return ms;
}

static double booleans(uint64_t *hash) {
    static wl_surface cubes[125], pair[2];
    const wl_frame middle = wl_slab_frame(0.15, 0.27, 0.428);
    workload wavy = wl_wavy(1);
    double ms;
    size_t i, k;
    for (i = 0; i < 125; i++) {
        wl_frame frame = wl_rotated();
        size_t rest = i;
        for (k = 0; k < 3; k++, rest /= 5) frame.origin[k] = 0.9 * (double)(rest % 5);
        wl_add_box(&cubes[i], &frame, 0.5, 0.5, 0.5);
    }
    wl_add_box(&pair[0], &middle, 0.5, 0.5, 0.5);
    pair[1] = wavy.surfaces[0];
    *hash = 14695981039346656037u;
    ms = boolean(cubes, 125, GXB_UNION, hash) + boolean(pair, 2, GXB_DIFFERENCE, hash);
    for (i = 0; i < 125; i++) {
        free(cubes[i].vertices);
        free(cubes[i].triangles);
    }
    free(pair[0].vertices);
    free(pair[0].triangles);
    wl_free(&wavy);
    return ms;
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        double (*run)(uint64_t *hash);
    } workloads[] = {{"step", steps}, {"contact", contacts}, {"cut", cuts}, {"boolean", booleans}};
    size_t i;
    for (i = 0; i < sizeof workloads / sizeof *workloads; i++)
        if (argc == 2 && strcmp(argv[1], workloads[i].name) == 0) {
            uint64_t hash = 0;
            const double ms = workloads[i].run(&hash);
            printf("%.2f %016llx\n", ms, (unsigned long long)hash);
            return 0;
        }
    fprintf(stderr, "usage: intrinsics step|contact|cut|boolean\n");
    return 2;
}
