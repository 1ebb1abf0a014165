/* creation.c - does creation work or refuse? Creates a Boolean, a complex and a body, clones a body and loads a
   saved one.

       creation made      everything must succeed
       creation refused   creation must fail with GX_ERROR_CONFIGURATION and leave nothing
       creation single    with x87 set to 24 bits everything must fail like this, and must succeed before and after

   Exit status 1, and a line for each different outcome. For builds that mislead the library: see flags.sh and
   wasm.sh. */
#define GXFEM_STATIC
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include <stdio.h>

static int wrong;

static void expect(const char *what, gx_result got, gx_result wanted, const void *object) {
    if (got == wanted && (object != NULL) == (wanted == GX_OK)) return;
    printf("%s: result %d instead of %d, %s\n", what, (int)got, (int)wanted, object ? "an object" : "no object");
    wrong = 1;
}

/* Digits of x87: 0 for 24, 3 for 64 */
static int set_digits(unsigned digits) {
#if defined(__i386__) || defined(__x86_64__)
    unsigned short word;
    __asm__ volatile("fnstcw %0" : "=m"(word));
    word = (unsigned short)((word & ~0x300u) | digits << 8);
    __asm__ volatile("fldcw %0" : : "m"(word));
    return 1;
#else
    (void)digits;
    return 0;
#endif
}

static const double corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const uint32_t tetrahedron[4] = {0, 1, 2, 3};
static gx_body_desc desc;
static gx_body *body;
static unsigned char *saved;
static size_t saved_size;

static void create(gx_result wanted) {
    gxb_boolean *boolean = NULL;
    gxb_complex *complex = NULL;
    gx_body *other = NULL;
    gxb_mesh mesh;
    gx_result result = gxb_boolean_create(NULL, &boolean, NULL);
    expect("Boolean", result, wanted, boolean);
    gxb_boolean_destroy(boolean);
    memset(&mesh, 0, sizeof mesh);
    mesh.positions = corners;
    mesh.node_count = 4;
    mesh.elements = tetrahedron;
    mesh.element_count = 1;
    result = gxb_complex_create(&mesh, NULL, &complex, NULL);
    expect("complex", result, wanted, complex);
    gxb_complex_destroy(complex);
    result = gx_body_create(&desc, &other, NULL);
    expect("body", result, wanted, other);
    gx_body_destroy(other);
}

static void copy(gx_result wanted) {
    gx_body *other = NULL;
    gx_result result = gx_body_clone(body, &other, NULL);
    expect("clone", result, wanted, other);
    gx_body_destroy(other);
    other = NULL;
    result = gx_body_load(saved, saved_size, NULL, &other, NULL);
    expect("loading", result, wanted, other);
    gx_body_destroy(other);
}

static int prepare(void) {
    if (gx_body_create(&desc, &body, NULL) != GX_OK || gx_body_save(body, NULL, 0, &saved_size, NULL) != GX_OK)
        return 0;
    saved = (unsigned char *)malloc(saved_size);
    return saved != NULL && gx_body_save(body, saved, saved_size, &saved_size, NULL) == GX_OK;
}

int main(int argc, char **argv) {
    const char *mode = argc == 2 ? argv[1] : "";
    desc.positions = corners;
    desc.node_count = 4;
    desc.elements = tetrahedron;
    desc.element_count = 1;
    desc.young = 1e5;
    desc.poisson = 0.3;
    desc.density = 1000;
    if (strcmp(mode, "refused") == 0) {
        create(GX_ERROR_CONFIGURATION);
        return wrong;
    }
    if (strcmp(mode, "made") != 0 && strcmp(mode, "single") != 0) {
        fprintf(stderr, "usage: creation made|refused|single\n");
        return 2;
    }
    if (!prepare()) {
        printf("no body to save\n");
        return 1;
    }
    create(GX_OK);
    copy(GX_OK);
    if (strcmp(mode, "single") == 0) {
        if (!set_digits(0)) {
            printf("no x87 here\n");
            return 1;
        }
        create(GX_ERROR_CONFIGURATION);
        copy(GX_ERROR_CONFIGURATION);
        set_digits(3);
        create(GX_OK);
        copy(GX_OK);
    }
    gx_body_destroy(body);
    free(saved);
    return wrong;
}
