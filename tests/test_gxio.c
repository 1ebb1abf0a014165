/* test_gxio.c - the readers and generators of the examples, examples/gxio.h and examples/gxshape.h. Files good and
   bad, the same mesh in every format. Stuffed shapes: angles, closed manifold boundary, volume, convergence,
   acceptance by the library.

   Random tests print their seed. */
#include "../examples/gxio.h"
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "body.h"
#include <unistd.h>

enum { SEEDS = 10 };

/* ---- files in a directory of their own ---- */

static char directory[] = "/tmp/test_gxio_XXXXXX";
static char path[64]; /* of the file written last */

static void make_directory(void) {
    memcpy(directory + sizeof directory - 7, "XXXXXX", 6);
    ck_assert_ptr_nonnull(mkdtemp(directory));
    path[0] = 0;
}

static void remove_directory(void) {
    if (path[0]) remove(path);
    ck_assert_int_eq(rmdir(directory), 0);
}

/* One file at a time: the one before is removed. */
static void put_bytes(const char *ending, const void *bytes, size_t length) {
    FILE *stream;
    if (path[0]) remove(path);
    snprintf(path, sizeof path, "%s/a%s", directory, ending);
    stream = fopen(path, "wb");
    ck_assert_ptr_nonnull(stream);
    ck_assert_uint_eq(fwrite(bytes, 1, length, stream), length);
    ck_assert_int_eq(fclose(stream), 0);
}
static void put(const char *ending, const char *text) { put_bytes(ending, text, strlen(text)); }

/* The error is one line, "PATH...", with `what` in it. */
static void expect_error(const gxio_error *error, const char *what, int line) {
    ck_assert_msg(strncmp(error->text, path, strlen(path)) == 0 && !strchr(error->text, '\n') &&
                      strstr(error->text + strlen(path), what),
                  "line %d: '%s' should be '%s...%s'", line, error->text, path, what);
}

static void refuse_mesh(const char *ending, const char *text, const char *what, int line) {
    gxio_mesh mesh;
    gxio_error error = {""};
    put(ending, text);
    ck_assert_msg(!gxio_mesh_load(path, &mesh, &error), "line %d: is read, but should be refused for '%s'", line, what);
    ck_assert(!mesh.positions && !mesh.elements && !mesh.node_lines && !mesh.element_lines);
    expect_error(&error, what, line);
}
#define REFUSE_MESH(ending, text, what) refuse_mesh(ending, text, what, __LINE__)

static gxio_surface load_surface(const char *spec, int *good, gxio_error *error) {
    gxio_surface surface;
    gxio_box none;
    memset(&none, 0, sizeof none);
    *good = gxio_surface_load(spec, &none, &surface, error);
    return surface;
}

static void refuse_surface(const char *ending, const char *text, const char *what, int line) {
    gxio_error error = {""};
    int good;
    gxio_surface surface;
    put(ending, text);
    surface = load_surface(path, &good, &error);
    ck_assert_msg(!good, "line %d: is read, but should be refused for '%s'", line, what);
    ck_assert(!surface.vertices && !surface.triangles && !surface.triangle_lines);
    expect_error(&error, what, line);
}
#define REFUSE_SURFACE(ending, text, what) refuse_surface(ending, text, what, __LINE__)

static gxio_mesh mesh_of(const char *spec) {
    gxio_mesh mesh;
    gxio_error error = {""};
    ck_assert_msg(gxio_mesh_load(spec, &mesh, &error), "%s", error.text);
    return mesh;
}

static gxio_mesh mesh_from(const char *ending, const char *text) {
    put(ending, text);
    return mesh_of(path);
}

static gxio_surface surface_from(const char *ending, const char *text) {
    gxio_error error = {""};
    gxio_surface surface;
    int good;
    put(ending, text);
    surface = load_surface(path, &good, &error);
    ck_assert_msg(good, "%s", error.text);
    return surface;
}

/* Reads the file cut off before each of its lines and, for accidents in memory, before each of its bytes. As long as
   lines up to `needed` are missing, it is refused. */
static void expect_truncation(const char *ending, const char *text, size_t needed, int surface) {
    size_t length, lines = 0;
    for (length = 0; length < strlen(text); length++) {
        const int whole_lines = length == 0 || text[length - 1] == '\n';
        gxio_error error = {""};
        gxio_mesh mesh;
        int good;
        put_bytes(ending, text, length);
        if (surface) {
            gxio_surface cut = load_surface(path, &good, &error);
            gxio_surface_release(&cut);
        } else {
            good = gxio_mesh_load(path, &mesh, &error);
            gxio_mesh_release(&mesh);
        }
        if (!good) expect_error(&error, "", (int)length);
        if (whole_lines)
            ck_assert_msg(!good || lines >= needed, "%zu lines are read, but %zu are needed", lines, needed);
        lines += text[length] == '\n';
    }
}

/* ---- meshes: two tetrahedra, five nodes in use, one not ---- */

#define POINTS "0 0 0\n1 0 0\n0 1 0\n7 8 9\n0 0 1\n0 0 -1.5\n"
static const double two_positions[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 7, 8, 9, 0, 0, 1, 0, 0, -1.5};
static const uint32_t two_elements[8] = {0, 1, 2, 4, 0, 2, 1, 5};

static const char medit[] =
    "MeshVersionFormatted 2\nDimension 3\nVertices 6\n0 0 0 0\n1 0 0 0\n0 1 0 0\n7 8 9 0\n0 0 1 0\n0 0 -1.5 0\n"
    "Tetrahedra 2\n1 2 3 5 0\n1 3 2 6 0\nEnd\n";
static const char gmsh_2[] =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body # 1\"\n$EndPhysicalNames\n"
    "$Nodes\n6\n10 0 0 0\n3 1 0 0\n77 0 1 0\n5 7 8 9\n4000000000 0 0 1\n6 0 0 -1.5\n$EndNodes\n"
    "$Elements\n4\n1 15 2 0 1 10\n2 2 3 0 1 7 10 3 77\n3 4 2 1 1 10 3 77 4000000000\n9 4 0 10 77 3 6\n$EndElements\n";
static const char gmsh_4[] =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 -2 1 1 1 0 0\n$EndEntities\n"
    "$Nodes\n3 6 3 4000000000\n2 5 1 2\n10\n3\n0 0 0 0.25 0.5\n1 0 0 0.5 0.5\n3 1 0 0\n3 1 0 "
    "4\n77\n5\n4000000000\n6\n0 1 0\n7 8 9\n0 0 1\n"
    "0 0 -1.5\n$EndNodes\n"
    "$Elements\n3 3 1 9\n2 5 2 1\n1 10 3 77\n3 1 4 1\n3 10 3 77 4000000000\n3 2 4 1\n9 10 77 3 6\n$EndElements\n"
    "$NodeData\n1\n\"$Nodes\"\n0\n$EndNodeData\n";
static const char vtk_3[] = "# vtk DataFile Version 3.0\n$ any # title\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD "
                            "FieldData 1\nTIME 1 1 double\n0.5\n"
                            "POINTS 6 double\n0 0 0 1 0 0 0 1 0\n7 8 9 0 0 1\n0 0 -1.5\n\nCELLS 3 14\n3 0 1 2\n4 0 1 2 "
                            "4\n4 0 2 1 5\nCELL_TYPES 3\n5 10\n10\n"
                            "CELL_DATA 3\nSCALARS POINTS int 1\nLOOKUP_TABLE default\n1 2 3\n";
static const char vtk_5[] = "# vtk DataFile Version 5.1\nvtk output\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 "
                            "float\n0 0 0 1 0 0 0 1 0\n7 8 9 0 0 1 0 0 -1.5\n"
                            "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\nCELLS 3 "
                            "8\nOFFSETS vtktypeint64\n0 4 8 \n"
                            "CONNECTIVITY vtktypeint64\n0 1 2 4 0\n2 1 5\nCELL_TYPES 2\n10\n10\n";

/* The six nodes and two elements, whichever file they come from. */
static void expect_two(gxio_mesh mesh) {
    gx_body_desc desc;
    gx_body *body = NULL;
    gx_view view;
    double low[3], high[3];
    ck_assert_uint_eq(mesh.node_count, 6);
    ck_assert_uint_eq(mesh.element_count, 2);
    ck_assert_mem_eq(mesh.positions, two_positions, sizeof two_positions);
    ck_assert_mem_eq(mesh.elements, two_elements, sizeof two_elements);
    ck_assert_str_eq(mesh.node_path, path);
    ck_assert_str_eq(mesh.element_path, path);
    gxio_mesh_bounds(&mesh, low, high); /* the fourth node is no part of the body */
    ck_assert(low[0] == 0 && low[1] == 0 && low[2] == -1.5 && high[0] == 1 && high[1] == 1 && high[2] == 1);
    memset(&desc, 0, sizeof desc);
    desc.positions = mesh.positions;
    desc.node_count = mesh.node_count;
    desc.elements = mesh.elements;
    desc.element_count = mesh.element_count;
    desc.young = 1e6;
    desc.poisson = 0.4;
    desc.density = 1000;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    view = view_of(body);
    ck_assert_uint_eq(view.copy_count, 5);
    ck_assert_double_eq_tol(view.volume, 2.5 / 6, 1e-15);
    gx_body_destroy(body);
    gxio_mesh_release(&mesh);
}

START_TEST(the_same_mesh_in_every_format) {
    expect_two(mesh_from(".mesh", medit));
    expect_two(mesh_from(".msh", gmsh_2));
    expect_two(mesh_from(".msh", gmsh_4));
    expect_two(mesh_from(".vtk", vtk_3));
}
END_TEST

/* Version 5 with its offsets, and the lines to which errors of the library are attributed. */
START_TEST(lines_of_nodes_and_elements) {
    static const uint32_t gmsh_2_lines[8] = {10, 11, 12, 13, 14, 15, 21, 22},
                          gmsh_4_lines[8] = {13, 14, 21, 22, 23, 24, 31, 33};
    static const uint32_t vtk_3_lines[8] = {9, 9, 9, 10, 10, 11, 15, 16};
    const struct {
        const char *ending, *text;
        const uint32_t *lines;
    } files[3] = {{".msh", gmsh_2, gmsh_2_lines}, {".msh", gmsh_4, gmsh_4_lines}, {".vtk", vtk_3, vtk_3_lines}};
    int i;
    for (i = 0; i < 3; i++) {
        gxio_mesh mesh = mesh_from(files[i].ending, files[i].text);
        ck_assert_mem_eq(mesh.node_lines, files[i].lines, 6 * sizeof(uint32_t));
        ck_assert_mem_eq(mesh.element_lines, files[i].lines + 6, 2 * sizeof(uint32_t));
        gxio_mesh_release(&mesh);
    }
}
END_TEST

START_TEST(vtk_with_offsets) {
    static const char types[] = "CELL_TYPES 2\n10\n10\n";
    static const char cells[] =
        "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8 \nCONNECTIVITY vtktypeint64\n0 1 2 4 0\n2 1 5\n";
    char text[2048];
    expect_two(mesh_from(".vtk", vtk_5));
    /* types before cells, and everything with carriage returns */
    snprintf(text, sizeof text,
             "# vtk DataFile Version 5.1\r\nt\r\nASCII\r\nDATASET UNSTRUCTURED_GRID\r\n%sPOINTS 6 float\r\n%s\r\n%s",
             types, POINTS, cells);
    expect_two(mesh_from(".vtk", text));
}
END_TEST

/* Corners come first in elements with nodes on their edges. */
START_TEST(quadratic_tetrahedra_by_their_corners) {
    char text[2048];
    static const char edges[] = "0.5 0 0\n0.5 0.5 0\n0 0.5 0\n0 0 0.5\n0.5 0 0.5\n0 0.5 0.5\n";
    gxio_mesh mesh;
    int format;
    for (format = 0; format < 2; format++) {
        static const double x[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
        if (format == 0)
            snprintf(text, sizeof text,
                     "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 float\n0 0 0\n1 0 "
                     "0\n0 1 0\n0 0 1\n%s"
                     "CELLS 1 11\n10 0 1 2 3 4 5 6 7 8 9\nCELL_TYPES 1\n24\n",
                     edges);
        else
            snprintf(text, sizeof text,
                     "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 "
                     "0\n0 0 1\n$EndNodes\n"
                     "$Elements\n1 1 1 1\n3 1 11 1\n1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n");
        mesh = mesh_from(format == 0 ? ".vtk" : ".msh", text);
        ck_assert_uint_eq(mesh.element_count, 1);
        ck_assert_mem_eq(mesh.positions, x, sizeof x);
        ck_assert(mesh.elements[0] == 0 && mesh.elements[1] == 1 && mesh.elements[2] == 2 && mesh.elements[3] == 3);
        gxio_mesh_release(&mesh);
    }
}
END_TEST

START_TEST(truncated_files) {
    static const size_t last_line[4] = {23, 34, 18, 19};
    expect_truncation(".msh", gmsh_2, last_line[0], 0);
    expect_truncation(".msh", gmsh_4, last_line[1], 0);
    expect_truncation(".vtk", vtk_3, last_line[2], 0);
    expect_truncation(".vtk", vtk_5, last_line[3], 0);
}
END_TEST

#define GMSH_2  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define GMSH_4  "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
#define NODES_2 "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
#define NODES_4 "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
#define TET_2   "$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n"

START_TEST(bad_gmsh_2) {
    REFUSE_MESH(".msh", "", ":1: the file ends where $MeshFormat should stand");
    REFUSE_MESH(".msh", "$NOD\n4\n", ":1: '$NOD' stands where $MeshFormat should");
    REFUSE_MESH(".msh", "$MeshFormat\n1 0 8\n", ":2: '1' is the format's version, but 2.2 or 4.1 is needed");
    REFUSE_MESH(".msh", "$MeshFormat\n4 0 8\n", ":2: '4' is the format's version");
    REFUSE_MESH(".msh", "$MeshFormat\n2.2 1 8\n", ":2: '1' is the file's type, but 0 (ASCII) is needed");
    REFUSE_MESH(".msh", "$MeshFormat\n2.2 0 8\n$Nodes\n", ":3: '$Nodes' stands where $EndMeshFormat should");
    REFUSE_MESH(".msh", GMSH_2 "$Comments\nabc\n", ":4: the file ends before $EndComments");
    REFUSE_MESH(".msh", GMSH_2 "Nodes\n", ":4: 'Nodes' stands where a section $... should");
    REFUSE_MESH(".msh", GMSH_2 TET_2, "the file has no $Nodes");
    REFUSE_MESH(".msh", GMSH_2 NODES_2, "the file has no $Elements");
    REFUSE_MESH(".msh", GMSH_2 NODES_2 NODES_2, ":12: a second section $Nodes");
    REFUSE_MESH(".msh", GMSH_2 NODES_2 TET_2 TET_2, ":16: a second section $Elements");
    REFUSE_MESH(".msh", GMSH_2 NODES_2 "$Elements\n1\n1 2 0 1 2 3\n$EndElements\n", ": the file has no tetrahedra");
    REFUSE_MESH(".msh", GMSH_2 "$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n" TET_2, ":7: a second node with the tag 1");
    REFUSE_MESH(".msh", GMSH_2 "$Nodes\n1\n1 0 nan 0\n", ":6: 'nan' is not a finite number");
    REFUSE_MESH(".msh", GMSH_2 "$Nodes\n1\n1 0 0\n$EndNodes\n", ":6: a coordinate is missing");
    REFUSE_MESH(".msh", GMSH_2 "$Nodes\n1\n-1 0 0 0\n", ":6: '-1' is an index out of range");
    REFUSE_MESH(".msh", GMSH_2 "$Nodes\n2\n1 0 0 0\n$EndNodes\n", ":7: '$EndNodes' is not an integer");
    REFUSE_MESH(".msh", GMSH_2 "$Nodes\n1\n1 0 0 0\n2 0 0 0\n$EndNodes\n", ":7: '2' stands where $EndNodes should");
    REFUSE_MESH(".msh", GMSH_2 "$Nodes\n999999999\n", ":5: '999999999' is a larger count than the file is long");
    REFUSE_MESH(".msh", GMSH_2 NODES_2 "$Elements\n1\n1 4 2 0 1 1 2 3\n$EndElements\n", ":13: an index is missing");
    REFUSE_MESH(".msh", GMSH_2 NODES_2 "$Elements\n1\n1 4 0 1 2 3 5\n$EndElements\n",
                ":13: there is no node with the tag 5");
    REFUSE_MESH(".msh", GMSH_2 NODES_2 "$Elements\n1\n1 4 0 1 2 3 0\n$EndElements\n",
                ":13: there is no node with the tag 0");
    REFUSE_MESH(".msh", GMSH_2 NODES_2 "$Elements\n1\n1 4 -2 1 2 3 4\n$EndElements\n", ":13: '-2' is a negative count");
    REFUSE_MESH(".msh", GMSH_2 NODES_2 "$Elements\n2\n1 4 0 1 2 3 4\n$EndElements\n",
                ":14: '$EndElements' is not an integer");
}
END_TEST

START_TEST(bad_gmsh_4) {
    REFUSE_MESH(".msh", GMSH_4 "$Nodes\n1 4 1 4\n3 1 0 5\n", ":6: '5' is a larger count");
    REFUSE_MESH(".msh", GMSH_4 "$Nodes\n1 3 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n",
                ":6: '4' is a larger count than the section's first line leaves");
    REFUSE_MESH(".msh", GMSH_4 "$Nodes\n1 2 1 2\n3 1 0 1\n1\n0 0 0\n$EndNodes\n",
                ":8: 1 nodes fewer than the section's first line says");
    REFUSE_MESH(".msh", GMSH_4 "$Nodes\n1 1\n3 1 0 1\n1\n0 0\n$EndNodes\n", ":9: '$EndNodes' is not a finite number");
    REFUSE_MESH(".msh", GMSH_4 NODES_4 "$Elements\n1 1 1 1\n3 1 4 2\n1 1 2 3 4\n$EndElements\n",
                ":18: '2' is a larger count than");
    REFUSE_MESH(".msh", GMSH_4 NODES_4 "$Elements\n1 2 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n",
                ":19: 1 elements fewer than");
    REFUSE_MESH(".msh", GMSH_4 NODES_4 "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3\n$EndElements\n",
                ":19: an index is missing");
    REFUSE_MESH(".msh", GMSH_4 NODES_4 "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 7\n$EndElements\n",
                ":19: there is no node with the tag 7");
    REFUSE_MESH(".msh", GMSH_4 NODES_4 "$Elements\n1 1 1 1\n3 1 4\n1 1 2 3 7\n$EndElements\n",
                ":18: a block's count is missing");
}
END_TEST

#define VTK  "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n"
#define FOUR "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n"

START_TEST(bad_vtk) {
    REFUSE_MESH(".vtk", "", ":1: the file does not start with '# vtk DataFile Version'");
    REFUSE_MESH(".vtk", "vtk\nt\nASCII\n", ":1: the file does not start with");
    REFUSE_MESH(".vtk", "# vtk DataFile Version 3.0\nt\nBINARY\n", ":3: 'BINARY' stands where ASCII should");
    REFUSE_MESH(".vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n",
                ":4: 'POLYDATA' is the kind of dataset, but UNSTRUCTURED_GRID is needed");
    REFUSE_MESH(".vtk", VTK "1 2 3\n", ":5: '1' stands where a section's name should");
    REFUSE_MESH(".vtk", VTK "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n", "the file has no POINTS");
    REFUSE_MESH(".vtk", VTK FOUR "CELL_TYPES 1\n10\n", "the file has no CELLS");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 1 5\n4 0 1 2 3\n", "the file has 1 CELLS, but 0 CELL_TYPES");
    REFUSE_MESH(".vtk", VTK FOUR FOUR, ":7: 'POINTS' occurs twice");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 1 5\n4 0 1 2 3\nCELLS 1 5\n", ":9: 'CELLS' occurs twice");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 1 5\n4 0 1 2 4\nCELL_TYPES 1\n10\n",
                ":8: node index 4 is out of range: the nodes are 0 to 3");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 1 5\n4 0 1 2 -1\nCELL_TYPES 1\n10\n", ":8: '-1' is an index out of range");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 1 4\n4 0 1 2 3\nCELL_TYPES 1\n10\n",
                ":8: '4' points are more than the section's size leaves");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 1 6\n4 0 1 2 3\nCELL_TYPES 1\n10\n",
                ":8: the cells end before the section's size is reached");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 2 1\n4 0 1 2 3\n", ":7: '1' is a smaller size than the number of cells");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n", ":8: a cell of type 10 with 3 points");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n24\n", ":8: a cell of type 24 with 4 points");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n", "the file has no tetrahedra");
    REFUSE_MESH(".vtk", VTK "POINTS 1 double\n0 0 inf\n", ":6: 'inf' is not a finite number");
    REFUSE_MESH(".vtk", VTK "POINTS 4000 double\n0 0 0\n", ":5: '4000' is a larger count than the file is long");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 2 4\nOFFSETS vtktypeint64\n1 4\n", ":9: '1' is an offset out of order");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 3 4\nOFFSETS vtktypeint64\n0 4 3\n", ":9: '3' is an offset out of order");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 2 5\nOFFSETS vtktypeint64\n0 4\n", ":9: '4' is not where the last cell ends");
    REFUSE_MESH(".vtk", VTK FOUR "CELLS 2 4\nOFFSETS vtktypeint64\n0 4\n0 1 2 3\n",
                ":10: '0' stands where CONNECTIVITY should");
}
END_TEST

/* ---- surfaces ---- */

static void expect_square(gxio_surface s) {
    static const double x[12] = {0, 0, 0.5, 1, 0, 0.5, 1, 1, 0.5, 0, 1, 0.5};
    static const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    ck_assert_uint_eq(s.vertex_count, 4);
    ck_assert_uint_eq(s.triangle_count, 2);
    ck_assert_mem_eq(s.vertices, x, sizeof x);
    ck_assert_mem_eq(s.triangles, triangles, sizeof triangles);
    gxio_surface_release(&s);
}

#define FACET(a, b, c) "facet normal 0 0 1\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet\n"
#define POLY                                                                                                           \
    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0.5 1 0 0.5\n1 1 0.5 0 1 0.5\n"
static const char stl[] =
    "solid a # name\n" FACET("0 0 .5", "1 0 .5", "1 1 .5") FACET("-0 0 0.5", "1.0 1 5e-1", "0 1 .5") "endsolid a\n";

START_TEST(the_same_surface_in_every_format) {
    expect_square(surface_from(".off", "OFF 4 1 0\n0 0 .5\n1 0 .5\n1 1 .5\n0 1 .5\n4 0 1 2 3\n"));
    expect_square(
        surface_from(".obj", "v 0 0 .5\nv 1 0\\\n .5\nv 1 1 .5\nvn 0 \\\n0 1\nv 0 1 \\\r\n.5\nf 1//1 2\\\n 3 \\\n4\n"));
    expect_square(surface_from(".stl", stl));
    expect_square(surface_from(".stl", "solid\n" FACET("0 0 .5", "1 0 .5", "1 1 .5") "endsolid\n\n  solid b\n" FACET(
                                           "0 0 .5", "1 1 .5", "0 1 .5") "endsolid b"));
    expect_square(surface_from(".vtk", POLY "POLYGONS 1 5\n4 0 1 2 3\nPOINT_DATA 4\nSCALARS a int\n"));
    expect_square(surface_from(".vtk", POLY "VERTICES 1 2\n1 0\nLINES 1 3\n2 0 1\nPOLYGONS 3 6\nOFFSETS "
                                            "vtktypeint64\n0 3 6\nCONNECTIVITY vtktypeint64\n0 1 2 0 2 3\n"));
}
END_TEST

/* Every second triangle of a strip is turned, so that all face one way. */
START_TEST(vtk_strips) {
    static const uint32_t triangles[6] = {0, 1, 3, 1, 2, 3};
    gxio_surface s = surface_from(".vtk", POLY "TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n");
    ck_assert_uint_eq(s.triangle_count, 2);
    ck_assert_mem_eq(s.triangles, triangles, sizeof triangles);
    gxio_surface_release(&s);
}
END_TEST

/* Binary STL of the triangles' corners, which are exact in single precision. Returns its length. */
static size_t binary_stl(unsigned char *bytes, const float *corners, uint32_t triangles) {
    uint32_t t, k, word;
    memset(bytes, 0, 84 + 50 * (size_t)triangles);
    memcpy(bytes, "solid is how some of them begin", 31);
    for (k = 0; k < 4; k++) bytes[80 + k] = (unsigned char)(triangles >> 8 * k);
    for (t = 0; t < triangles; t++)
        for (k = 0; k < 36; k++) {
            memcpy(&word, corners + 9 * t + k / 4, sizeof word);
            bytes[84 + 50 * t + 12 + k] = (unsigned char)(word >> 8 * (k % 4));
        }
    return 84 + 50 * (size_t)triangles;
}

START_TEST(binary_stl_files) {
    static const float corners[18] = {0, 0, 0.5f, 1, 0, 0.5f, 1, 1, 0.5f, -0.0f, 0, 0.5f, 1, 1, 0.5f, 0, 1, 0.5f};
    unsigned char bytes[184];
    const size_t length = binary_stl(bytes, corners, 2);
    gxio_error error = {""};
    int good;
    put_bytes(".stl", bytes, length);
    expect_square(load_surface(path, &good, &error));
    put_bytes(".stl", bytes, length - 1);
    load_surface(path, &good, &error);
    ck_assert(!good);
    expect_error(&error, ": is binary, but not as long as its number of triangles asks for", __LINE__);
    bytes[84 + 50 + 12 + 3] = 0x7f; /* the second triangle's first coordinate is infinite */
    bytes[84 + 50 + 12 + 2] = 0x80;
    put_bytes(".stl", bytes, length);
    load_surface(path, &good, &error);
    ck_assert(!good);
    expect_error(&error, ": triangle 1 has a coordinate that is not finite", __LINE__);
}
END_TEST

START_TEST(bad_surfaces) {
    REFUSE_SURFACE(".stl", "", ":1: the file ends where solid should stand");
    REFUSE_SURFACE(".stl", "hello\n", ":1: 'hello' stands where solid should");
    REFUSE_SURFACE(".stl", "solid\nfact\n", ":2: 'fact' stands where facet or endsolid should");
    REFUSE_SURFACE(".stl", "solid\nfacet\nouter loop\nvertex 0 0\n", ":4: a coordinate is missing");
    REFUSE_SURFACE(".stl", "solid\nfacet\nouter loop\nvertex 0 0 nan\n", ":4: 'nan' is not a finite number");
    REFUSE_SURFACE(".stl", "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
                   ":6: 'endloop' stands where vertex should");
    REFUSE_SURFACE(".stl", "solid\n" FACET("0 0 0", "1 0 0", "0 1 0\nvertex 1 1 1"),
                   ":7: 'vertex' stands where endloop should");
    REFUSE_SURFACE(".stl", "solid\nendsolid\nsold\n", ":3: 'sold' stands where solid should");
    REFUSE_SURFACE(".vtk", VTK, ":4: 'UNSTRUCTURED_GRID' is the kind of dataset, but POLYDATA is needed");
    REFUSE_SURFACE(".vtk", POLY, ": the file has neither POLYGONS nor TRIANGLE_STRIPS");
    REFUSE_SURFACE(".vtk", POLY "POLYGONS 1 4\n3 0 1 4\n",
                   ":9: vertex index 4 is out of range: the file has 4 vertices");
    REFUSE_SURFACE(".ply", "ply\n", ": is no cut");
    expect_truncation(".stl", stl, 16, 1);
    expect_truncation(".vtk", POLY "POLYGONS 1 5\n4 0 1 2 3\n", 9, 1);
}
END_TEST

/* ---- generated meshes ---- */

typedef struct edge {
    uint32_t low, high;
    int way;
} edge;
typedef struct face {
    uint32_t sorted[3], corner[3];
} face;

static int compare_edges(const void *a, const void *b) {
    const edge *p = (const edge *)a, *q = (const edge *)b;
    return p->low != q->low ? (p->low < q->low ? -1 : 1) : p->high != q->high ? (p->high < q->high ? -1 : 1) : 0;
}
static int compare_faces(const void *a, const void *b) {
    const face *p = (const face *)a, *q = (const face *)b;
    int k;
    for (k = 0; k < 3; k++)
        if (p->sorted[k] != q->sorted[k]) return p->sorted[k] < q->sorted[k] ? -1 : 1;
    return 0;
}

/* All faces of all elements, sorted so that the two sides of one stand together. */
static face *faces_of(const gxio_mesh *mesh) {
    static const int corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    face *faces = (face *)malloc(4 * mesh->element_count * sizeof *faces);
    size_t f;
    int k, j;
    for (f = 0; f < 4 * mesh->element_count; f++) {
        for (k = 0; k < 3; k++)
            faces[f].sorted[k] = faces[f].corner[k] = mesh->elements[4 * (f / 4) + (size_t)corners[f % 4][k]];
        for (k = 0; k < 2; k++)
            for (j = 0; j < 2; j++)
                if (faces[f].sorted[j] > faces[f].sorted[j + 1]) {
                    const uint32_t swap = faces[f].sorted[j];
                    faces[f].sorted[j] = faces[f].sorted[j + 1];
                    faces[f].sorted[j + 1] = swap;
                }
    }
    qsort(faces, 4 * mesh->element_count, sizeof *faces, compare_faces);
    return faces;
}

/* Vertices - edges + triangles of the mesh's boundary, each of whose edges must belong to two triangles, once each way.
 */
static long boundary_euler(const gxio_mesh *mesh) {
    const size_t count = 4 * mesh->element_count;
    face *faces = faces_of(mesh);
    edge *edges = (edge *)malloc(3 * count * sizeof *edges);
    unsigned char *used = (unsigned char *)calloc(mesh->node_count, 1);
    size_t f, e, edge_count = 0;
    long euler = 0;
    int k;
    for (f = 0; f < count; f++) {
        if (f + 1 < count && compare_faces(&faces[f], &faces[f + 1]) == 0) {
            ck_assert(f + 2 == count || compare_faces(&faces[f], &faces[f + 2]) != 0);
            f++;
            continue;
        }
        euler++;
        for (k = 0; k < 3; k++) {
            const uint32_t a = faces[f].corner[k], b = faces[f].corner[(k + 1) % 3];
            edges[edge_count].low = a < b ? a : b;
            edges[edge_count].high = a < b ? b : a;
            edges[edge_count++].way = a < b ? 1 : -1;
            euler += !used[a];
            used[a] = 1;
        }
    }
    qsort(edges, edge_count, sizeof *edges, compare_edges);
    ck_assert_uint_eq(edge_count % 2, 0);
    for (e = 0; e < edge_count; e += 2) {
        ck_assert_int_eq(compare_edges(&edges[e], &edges[e + 1]), 0);
        ck_assert_int_eq(edges[e].way + edges[e + 1].way, 0);
        ck_assert(e + 2 == edge_count || compare_edges(&edges[e], &edges[e + 2]) != 0);
        euler--;
    }
    free(faces);
    free(edges);
    free(used);
    return euler;
}

/* Sum of the elements' volumes, each of which must be positive. */
static double volume_of(const double *positions, const uint32_t *elements, size_t count) {
    double volume = 0;
    size_t e;
    for (e = 0; e < count; e++) {
        const double determinant = gxio_element_determinant(positions, elements + 4 * e);
        ck_assert(determinant > 0);
        volume += determinant / 6;
    }
    return volume;
}

/* Smallest and largest angle between faces, degrees: between the normals of the two faces at an edge. */
static void dihedral_range(const gxshape_mesh *mesh, double range[2]) {
    size_t e;
    int i, j, k;
    range[0] = 180;
    range[1] = 0;
    for (e = 0; e < mesh->element_count; e++) {
        double normal[4][3]; /* outward, of the face opposite to each corner */
        for (i = 0; i < 4; i++) {
            const double *x[4];
            double u[3], v[3], side = 0, length;
            for (j = 0; j < 4; j++) x[j] = mesh->positions + 3 * (size_t)mesh->elements[4 * e + (size_t)((i + j) % 4)];
            for (k = 0; k < 3; k++) {
                u[k] = x[2][k] - x[1][k];
                v[k] = x[3][k] - x[1][k];
            }
            for (k = 0; k < 3; k++) normal[i][k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
            for (k = 0; k < 3; k++) side += normal[i][k] * (x[0][k] - x[1][k]);
            length = side > 0 ? -gxshape_length(normal[i]) : gxshape_length(normal[i]);
            for (k = 0; k < 3; k++) normal[i][k] /= length;
        }
        for (i = 0; i < 4; i++)
            for (j = 0; j < i; j++) {
                const double cosine =
                    -(normal[i][0] * normal[j][0] + normal[i][1] * normal[j][1] + normal[i][2] * normal[j][2]);
                const double angle = 57.29577951308232 * acos(cosine);
                range[0] = fmin(range[0], angle);
                range[1] = fmax(range[1], angle);
            }
    }
}

/* A sum of eight waves, in a ball of radius 3. */
typedef struct waves {
    double k[8][3], phase[8];
} waves;

static double waves_value(const void *shape, const double x[3]) {
    const waves *w = (const waves *)shape;
    double value = 0;
    int i;
    for (i = 0; i < 8; i++) value += sin(w->k[i][0] * x[0] + w->k[i][1] * x[1] + w->k[i][2] * x[2] + w->phase[i]);
    return fmax(value, gxshape_length(x) - 3);
}

/* The proven bounds of LS, for any function; here with features from many spacings down to a fraction of one */
START_TEST(angles_are_bounded) {
    /* clang-format off */
    const double low[3] = { -3.1, -3.1, -3.1 }, high[3] = { 3.1, 3.1, 3.1 }, steepness = ldexp(1, _i % 5);
    gxshape_mesh mesh;
    double range[2];
    waves w;
    int i, k;
    random_seed((uint64_t)_i);
    for (i = 0; i < 8; i++) {
        for (k = 0; k < 3; k++) w.k[i][k] = steepness * random_real(-1, 1);
        w.phase[i] = random_real(0, 6.283185307179586);
    }
    CHECK_SEED(gxshape_stuff(waves_value, &w, low, high, 0.3, &mesh) == NULL, _i);
    dihedral_range(&mesh, range);
    volume_of(mesh.positions, mesh.elements, mesh.element_count);
    ck_assert_msg(range[0] >= 10.7 && range[1] <= 164.8, "seed %d: angles are %g to %g degrees", _i, range[0], range[1]);
    gxshape_mesh_release(&mesh);
}
END_TEST

/* One connected, closed mesh of positive elements, which the library accepts. Returns its volume. */
static double expect_solid(const gxio_mesh *mesh, long euler) {
    const double volume = volume_of(mesh->positions, mesh->elements, mesh->element_count);
    gx_body_desc desc;
    gx_body *body = NULL;
    gx_view view;
    ck_assert_int_eq(boundary_euler(mesh), euler);
    memset(&desc, 0, sizeof desc);
    desc.positions = mesh->positions; desc.node_count = mesh->node_count;
    desc.elements = mesh->elements; desc.element_count = mesh->element_count;
    desc.young = 1e6; desc.poisson = 0.4; desc.density = 1000;
    ck_assert_int_eq(gx_body_create(&desc, &body, NULL), GX_OK);
    view = view_of(body);
    ck_assert_uint_eq(view.fragment_count, 1);
    ck_assert_uint_eq(view.copy_count, mesh->node_count);
    ck_assert_double_eq_tol(view.volume, volume, 1e-12 * volume);
    gx_body_destroy(body);
    return volume;
}

/* The boundary's nodes lie on the surface, so the volume is of second order: halving the spacing quarters its error. */
static void expect_convergence(const char *format, double exact, long euler) {
    double error[3];
    char spec[40];
    int i;
    for (i = 0; i < 3; i++) {
        gxio_mesh mesh;
        snprintf(spec, sizeof spec, format, 0.3 / (1 << i));
        mesh = mesh_of(spec);
        error[i] = exact - expect_solid(&mesh, euler);
        gxio_mesh_release(&mesh);
    }
    ck_assert_msg(error[0] > 0 && error[0] < 0.1 * exact, "error %g of %g", error[0], exact);
    for (i = 0; i < 2; i++) ck_assert_msg(error[i] / error[i + 1] > 3 && error[i] / error[i + 1] < 5, "errors %g, %g", error[i], error[i + 1]);
}

START_TEST(balls_and_rings) {
    const double pi = 3.141592653589793;
    expect_convergence("ball:1,%g", 4 * pi / 3, 2);
    expect_convergence("torus:1,0.4,%g", 2 * pi * pi * 0.4 * 0.4, 0);
}
END_TEST

/* Nodes of the boundary are at distance 1 from the centre, to the tolerance of the root. */
START_TEST(boundary_lies_on_the_surface) {
    gxio_mesh mesh = mesh_of("ball:1,0.15");
    const size_t count = 4 * mesh.element_count;
    face *faces = faces_of(&mesh);
    size_t f;
    int k;
    for (f = 0; f < count; f++) {
        if (f + 1 < count && compare_faces(&faces[f], &faces[f + 1]) == 0) { f++; continue; }
        for (k = 0; k < 3; k++) ck_assert_double_eq_tol(gxshape_length(mesh.positions + 3 * faces[f].corner[k]), 1, 1e-11);
    }
    free(faces);
    gxio_mesh_release(&mesh);
}
END_TEST

static const struct { const char *name, *small; size_t elements; long euler; } shapes[4] = {
    { "octopus", "octopus:0.05", 23344, 2 }, { "bunny", "bunny:0.02", 18481, 2 }, { "armadillo", "armadillo:10", 54985, 2 },
    /* element counts of the meshes that they stand for; the upright ring is a handle */
    { "objects", "objects:0.1", 159000, 0 } };
/* clang-format on */

START_TEST(shapes_are_solids) {
    gxio_mesh fine = mesh_of(shapes[_i].name), coarse = mesh_of(shapes[_i].small), again = mesh_of(shapes[_i].small);
    ck_assert_double_eq_tol((double)fine.element_count / (double)shapes[_i].elements, 1, 0.05);
    expect_solid(&fine, shapes[_i].euler);
    expect_solid(&coarse, shapes[_i].euler);
    ck_assert_uint_eq(coarse.element_count, again.element_count);
    ck_assert_mem_eq(coarse.positions, again.positions, 3 * coarse.node_count * sizeof(double));
    ck_assert_mem_eq(coarse.elements, again.elements, 4 * coarse.element_count * sizeof(uint32_t));
    gxio_mesh_release(&fine);
    gxio_mesh_release(&coarse);
    gxio_mesh_release(&again);
}
END_TEST

/* Tubes as thin as GXSHAPE_THINNEST, in any direction and place, come out connected. */
START_TEST(thin_tubes_stay_whole) {
    gxshape_field field;
    gxshape_mesh made;
    gxio_mesh mesh;
    gxio_error error;
    int k;
    random_seed((uint64_t)_i);
    memset(&field, 0, sizeof field);
    field.part_count = 1;
    field.parts[0].kind = GXSHAPE_CAPSULE;
    for (k = 0; k < 3; k++) {
        field.parts[0].p[k] = random_real(-10, -5);
        field.parts[0].q[k] = random_real(5, 10);
    }
    memset(&mesh, 0, sizeof mesh);
    CHECK_SEED(gxio_take_shape("tube", gxshape_fill(&field, 1, &made), &made, &mesh, &error), _i);
    expect_solid(&mesh, 2);
    gxio_mesh_release(&mesh);
}
END_TEST

static double everywhere(const void *shape, const double x[3]) {
    (void)shape;
    (void)x;
    return -1;
}
static double nowhere(const void *shape, const double x[3]) {
    (void)shape;
    (void)x;
    return 1;
}

START_TEST(bad_shapes) {
    static const char *const bad[] = {
        "octopus:",    "octopus:0",      "octopus:-1",  "octopus:0.06",    "octopus:nan",      "bunny:1",
        "armadillo:x", "objects:0.1,2",  "ball:",       "ball:1",          "ball:1,0",         "ball:1,2",
        "ball:-1,1",   "ball:1,0.00001", "torus:1,0.3", "torus:1,0.3,0.5", "torus:0.2,0.3,0.1"};
    const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
    gxshape_mesh made;
    gxio_mesh mesh;
    gxio_error error;
    size_t i;
    for (i = 0; i < sizeof bad / sizeof *bad; i++) {
        ck_assert_msg(!gxio_mesh_load(bad[i], &mesh, &error), "%s", bad[i]);
        ck_assert_msg(strncmp(error.text, bad[i], strlen(bad[i])) == 0 && !strchr(error.text, '\n'), "%s", error.text);
        ck_assert_ptr_null(mesh.positions);
    }
    ck_assert_str_eq(gxshape_stuff(everywhere, NULL, low, high, 0.5, &made), "reaches beyond its box");
    ck_assert_str_eq(gxshape_stuff(nowhere, NULL, low, high, 0.5, &made),
                     "is smaller than its spacing: no node of the lattice lies inside");
    ck_assert_ptr_null(made.positions);
}
END_TEST

/* ---- blades ---- */

/* Lines without and with blanks, ends of lines of both kinds, no end of the last one; a comment is no frame. */
START_TEST(blade_frame_by_frame) {
    static const char text[] = "# edge\n1 2 3  4 5 6 # at first\r\n\t-1e3 2 3 \\\n 4 5 .5\n   # not yet\n \r\n\n"
                               "1 1 1 2 2 2 3 3 3\n\n\n";
    static const size_t first[5] = {0, 2, 4, 4, 4}, count[5] = {2, 2, 0, 0, 3}, lines[5] = {2, 3, 6, 7, 8};
    gxio_blade blade;
    gxio_error error = {""};
    size_t i;
    put(".txt", text);
    ck_assert_msg(gxio_blade_load(path, &blade, &error), "%s", error.text);
    ck_assert_uint_eq(blade.edge_count, 5); /* lifted after the last edge anyway */
    for (i = 0; i < 5; i++) {
        ck_assert_uint_eq(blade.edges[i].first, first[i]);
        ck_assert_uint_eq(blade.edges[i].count, count[i]);
        ck_assert_uint_eq(blade.edges[i].line, lines[i]);
    }
    ck_assert(blade.points[6] < -999.0 && blade.points[11] > 0.4 && blade.points[20] > 2.9);
    gxio_blade_release(&blade);
    put(".txt", "\n0 0 0 1 1 1");
    ck_assert_msg(gxio_blade_load(path, &blade, &error), "%s", error.text);
    ck_assert_uint_eq(blade.edge_count, 2);
    ck_assert_uint_eq(blade.edges[0].count, 0);
    ck_assert_uint_eq(blade.edges[1].count, 2);
    gxio_blade_release(&blade);
}
END_TEST

static void refuse_blade(const char *text, const char *what, int line) {
    gxio_blade blade;
    gxio_error error = {""};
    put(".txt", text);
    ck_assert_msg(!gxio_blade_load(path, &blade, &error), "line %d: is read, but should be refused", line);
    ck_assert(!blade.points && !blade.edges);
    expect_error(&error, what, line);
}
#define REFUSE_BLADE(text, what) refuse_blade(text, what, __LINE__)

START_TEST(bad_blades) {
    REFUSE_BLADE("", ": has no edge");
    REFUSE_BLADE("# 1 2 3 4 5 6\n\n", ": has no edge");
    REFUSE_BLADE("\n1 2 3\n", ":2: the edge has one point");
    REFUSE_BLADE("1 2 3 4 5 6\n\n1 2 3 4 5 6 7 8 9\n# 0\n1 2 3 4 5 6", ":5: the edge has 2 points, and 3 in line 3");
    REFUSE_BLADE("1 2 3 4 5\n1 2 3 4 5 6\n", ":1: a coordinate is missing");
    REFUSE_BLADE("1 2 3 4 5 6\n1 2 3 4 5", ":2: the file ends where a coordinate should stand");
    REFUSE_BLADE("1 2 3 x 5 6\n", ":1: 'x' is not a finite number");
    REFUSE_BLADE("1 2 3 4 nan 6\n", ":1: 'nan' is not a finite number");
    REFUSE_BLADE("1,2,3 4,5,6\n", ":1: '1,2,3' is not a finite number");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("gxio");
    TCase *files = tcase_create("files"), *shape = tcase_create("shapes");
    tcase_add_checked_fixture(files, make_directory, remove_directory);
    tcase_add_test(files, the_same_mesh_in_every_format);
    tcase_add_test(files, lines_of_nodes_and_elements);
    tcase_add_test(files, vtk_with_offsets);
    tcase_add_test(files, quadratic_tetrahedra_by_their_corners);
    tcase_add_test(files, truncated_files);
    tcase_add_test(files, bad_gmsh_2);
    tcase_add_test(files, bad_gmsh_4);
    tcase_add_test(files, bad_vtk);
    tcase_add_test(files, the_same_surface_in_every_format);
    tcase_add_test(files, vtk_strips);
    tcase_add_test(files, binary_stl_files);
    tcase_add_test(files, bad_surfaces);
    tcase_add_test(files, blade_frame_by_frame);
    tcase_add_test(files, bad_blades);
    tcase_set_timeout(files, 60);
    tcase_set_timeout(shape, 120);
    tcase_add_loop_test(shape, angles_are_bounded, 0, SEEDS);
    tcase_add_test(shape, balls_and_rings);
    tcase_add_test(shape, boundary_lies_on_the_surface);
    tcase_add_loop_test(shape, shapes_are_solids, 0, 4);
    tcase_add_loop_test(shape, thin_tubes_stay_whole, 0, SEEDS);
    tcase_add_test(shape, bad_shapes);
    suite_add_tcase(suite, files);
    suite_add_tcase(suite, shape);
    return run_suite(suite);
}
