/* Models from files: written here, so that paper knows the answer; of other people, whose makers say where the joints
 * are (models/free, models/brlcad READMEs); OpenFlight byte by byte from its specification; and files with octets
 * turned. */
#include "tests/check.h"

#include <sys/stat.h>
#include <zlib.h>

#include "entities/catalog/catalog.h"
#include "entities/import/model_import.h"

static char folder[64];

static void write_file(char path[128], const char *name, const void *bytes, size_t octets)
{
    snprintf(path, 128, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(bytes, 1, octets, file) == octets && fclose(file) == 0);
}

static void write_text(char path[128], const char *name, const char *text)
{
    write_file(path, name, text, strlen(text));
}

static Status import_quietly(Model *model, ModelImport *report, const char *path)
{
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = model_import(model, report, path);
    log_set_sink(NULL, NULL);
    return status;
}

static void refused(const char *path, Status want, const char *said)
{
    Model        model = {.part_count = 77};
    const Status status = import_quietly(&model, NULL, path);
    if (status != want || !strstr(check_said, said))
        fail_msg("%s: %s, said '%s'; wanted %s, '%s'", path, status_name(status), check_said, status_name(want), said);
    assert_int_equal(model.part_count, 77);
}

static const ModelPart *part_called(const Model *model, const char *name)
{
    for (int i = 0; i < model->part_count; i++)
        if (strcmp(model->part[i].name, name) == 0) return &model->part[i];
    fail_msg("no part %s", name);
    return NULL;
}

static int node_called(const Model *model, const char *name)
{
    for (int i = 0; i < model->node_count; i++)
        if (strcmp(model->node[i].name, name) == 0) return i;
    fail_msg("no node %s", name);
    return -1;
}

/* Box of a part in body axes with these joint values. */
static void part_box(double low[3], double high[3], const Model *model, const ModelPart *part, const double *value)
{
    NodePose pose[64];
    CHECK(model->node_count <= 64);
    model_pose(pose, model, value);
    for (int i = 0; i < 3; i++) low[i] = INFINITY, high[i] = -INFINITY;
    for (int t = 3 * part->first_triangle; t < 3 * (part->first_triangle + part->triangle_count); t++) {
        double p[3];
        m3_mul_v3(p, pose[part->node].r_body_from_node, model->vertex[model->triangle[t / 3][t % 3]]);
        for (int i = 0; i < 3; i++) {
            p[i] += pose[part->node].p_body[i];
            low[i] = fmin(low[i], p[i]);
            high[i] = fmax(high[i], p[i]);
        }
    }
}

/* A block 2 x 4 x 6 in x, y, z from the origin, 12 triangles outward. */
#define BLOCK                                                                                                          \
    "v 0 0 0\nv 2 0 0\nv 2 4 0\nv 0 4 0\nv 0 0 6\nv 2 0 6\nv 2 4 6\nv 0 4 6\n"                                         \
    "o block\nf 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\n"              \
    "f 4 1 5\nf 4 5 8\n"

/* ---- from paper ------------------------------------------------------------------------------------ */

static void a_block_lies_as_its_axes_say(void **state)
{
    (void)state;
    char        path[128], yaml[128];
    Model       m;
    ModelImport r;
    write_text(path, "block.obj", BLOCK);
    /* nobody said: +z forward, +y up: 6 long, 2 wide, 4 high, on its base's centre; left is +x, so right is -x */
    assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
    CHECK(r.axes_assumed && !r.sidecar[0] && r.edges.open == 0 && r.smoothed_parts == 1 && m.part_count == 1);
    assert_string_equal(m.name, "block");
    assert_string_equal(m.part[0].name, "block");
    CHECK(m.length_m == 6 && m.width_m == 2 && m.height_m == 4 && m.box_low[0] == -3 && m.box_high[2] == 0);
    CHECK(r.p_origin_file[0] == 1 && r.p_origin_file[1] == 0 && r.p_origin_file[2] == 3);
    CHECK(r.r_body_from_file[2] == 1 && r.r_body_from_file[3] == -1 && r.r_body_from_file[7] == -1);
    assert_int_equal(model_validate(&m), STATUS_OK);
    /* 90 degree edges stay sharp: three vertices a corner, normals along the axes */
    assert_int_equal(m.vertex_count, 24);
    for (int v = 0; v < m.vertex_count; v++)
        CHECK(fmax(fabsf(m.normal[v][0]), fmax(fabsf(m.normal[v][1]), fabsf(m.normal[v][2]))) == 1);
    model_destroy(&m);

    write_text(yaml, "block.yaml",
               "scale: 0.5\naxes: +x +z\norigin: 0 0 0\ncrease_deg: 100\nname: A Block\nmaterials: {'*': canvas}\n");
    assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
    CHECK(!r.axes_assumed && strcmp(r.sidecar, yaml) == 0 && r.material_parts[MATERIAL_BY_SIDECAR] == 1);
    assert_string_equal(m.name, "A_Block");
    assert_string_equal(m.part[0].material, "canvas");
    /* x forward; y left, so 0 .. 4 becomes -2 .. 0 m to the right; z up */
    CHECK(m.box_low[0] == 0 && m.box_high[0] == 1 && m.box_low[1] == -2 && m.box_high[1] == 0 && m.box_low[2] == -3);
    /* round corners: weighted by angle, whatever the diagonals: along (1 1 1) / sqrt 3 */
    assert_int_equal(m.vertex_count, 8);
    for (int v = 0; v < 8; v++)
        for (int i = 0; i < 3; i++) CHECK_NEAR(fabsf(m.normal[v][i]), 0.57735026918962576, 1e-7); /* float */
    assert_int_equal(model_validate(&m), STATUS_OK);
    model_destroy(&m);

    /* the same packed, and through the sidecar's own name */
    char packed[160];
    snprintf(packed, sizeof packed, "%s/packed.obj.gz", folder);
    gzFile gz = gzopen(packed, "wb");
    CHECK(gzwrite(gz, BLOCK, (unsigned)strlen(BLOCK)) > 0 && gzclose(gz) == Z_OK);
    write_text(yaml, "other.yaml", "file: packed.obj.gz\naxes: +z +y\n");
    assert_int_equal(import_quietly(&m, &r, yaml), STATUS_OK);
    CHECK(m.length_m == 6 && m.triangle_count == 12);
    assert_string_equal(m.name, "packed");
    model_destroy(&m);
}

static void what_is_odd_is_counted_and_what_is_broken_refused(void **state)
{
    (void)state;
    char        path[128];
    Model       m;
    ModelImport r;
    /* no lid, a triangle of two points, one of three on a line, and more in another material */
    write_text(path, "odd.mtl", "newmtl skin\nKd 0.1 0.1 0.1\nnewmtl window_front\nKd 1 1 1\n");
    write_text(path, "odd.obj",
               "mtllib odd.mtl\nusemtl skin\nv 0 0 0\nv 2 0 0\nv 2 4 0\nv 0 4 0\nv 0 0 6\nv 2 0 6\nv 2 4 6\nv 0 4 6\nv "
               "1 0 0\no block\n"
               "f 1 4 3\nf 1 3 2\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n"
               "f 1 2 2\nf 1 9 2\nusemtl window_front\nf 1 4 3\nf 1 3 2\nf 1 2 6\n");
    assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
    assert_int_equal(r.degenerate_triangles, 2);
    assert_int_equal(m.part_count, 2);
    assert_string_equal(m.part[1].name, "block~2");
    assert_string_equal(m.part[1].material, "glass_window");
    CHECK(r.material_parts[MATERIAL_BY_NAME] == 1 && r.material_parts[MATERIAL_BY_COLOUR] == 1);
    /* the rim of four; and 1-4, 4-3, 3-2, 2-6, 6-1 of the three triangles */
    assert_int_equal((int)r.edges.open, 4 + 5);
    assert_int_equal(r.edges.open_parts, 2);
    log_set_sink(check_listen, NULL);
    CHECK(model_check(&m) == STATUS_OK && model_validate(&m) == STATUS_BAD_VALUE);
    log_set_sink(NULL, NULL);
    model_destroy(&m);

    write_text(path, "nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    refused(path, STATUS_BAD_VALUE, "not a finite number");
    write_text(path, "far.obj", "v 0 0 0\nv 1e9 0 0\nv 0 1 0\nf 1 2 3\n");
    refused(path, STATUS_BAD_VALUE, "larger than 100 km");
    write_text(path, "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    refused(path, STATUS_BAD_VALUE, "without area");
    write_text(path, "points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n");
    refused(path, STATUS_BAD_VALUE, "no triangles");
    write_text(path, "cut.glb", "glTF\2\0\0");
    refused(path, STATUS_BAD_VALUE, "cannot be read");
    write_text(path, "what.xyzzy", "?");
    refused(path, STATUS_UNSUPPORTED, "no reader");
    write_text(path, "broken.obj.gz", "\x1f\x8b\x08 not really");
    refused(path, STATUS_BAD_VALUE, "cannot be read");
    snprintf(path, sizeof path, "%s/none.obj", folder);
    refused(path, STATUS_IO, "cannot open");
    refused(folder, STATUS_IO, "a directory, not a regular file");

    write_text(path, "joint.obj", BLOCK);
    char yaml[128];
    write_text(yaml, "joint.yaml", "joints:\n- {nodes: turret, axis: yaw}\n");
    refused(path, STATUS_BAD_VALUE, "joint.yaml:2: joints: no node of the file matches");
    write_text(yaml, "joint.yaml", "joints:\n- {nodes: block, axis: yaw}\n");
    refused(path, STATUS_BAD_VALUE, "pivot: is missing");
    write_text(yaml, "joint.yaml", "joints:\n- {nodes: block, pivot: centre}\n");
    refused(path, STATUS_BAD_VALUE, "axis: is missing");
    write_text(yaml, "joint.yaml", "joints:\n- {nodes: block, pivot: centre, axis: yaw, parent: hull}\n");
    refused(path, STATUS_BAD_VALUE, "parent: no joint has this name");
    write_text(yaml, "joint.yaml", "\nmaterials: {a: unobtainium}\n");
    refused(path, STATUS_BAD_VALUE, "joint.yaml:2: materials: 'unobtainium' is not a row of etc/materials.csv");
    write_text(yaml, "joint.yaml", "drop: [block]\n");
    refused(path, STATUS_BAD_VALUE, "that the sidecar does not drop");
    write_text(yaml, "joint.yaml", "drop: [blok]\n");
    assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
    CHECK(strstr(check_said, "joint.yaml:1: drop: nothing matches 'blok'"));
    model_destroy(&m);
}

/* ---- glTF ------------------------------------------------------------------------------------------------ */

/* A tetrahedron of corner 1 m below `depth` nodes, each 1 m on along x, the first mirrored in x. */
static size_t make_gltf(char *out, size_t size, int depth)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    struct {
        float    corner[4][3];
        uint16_t index[12];
    } data = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}};
    const uint8_t *bytes = (const uint8_t *)&data;
    char           base64[128];
    size_t         n = 0;
    assert_int_equal(sizeof data, 72);
    for (size_t i = 0; i < sizeof data; i += 3) {
        const uint32_t w = (uint32_t)bytes[i] << 16 | (uint32_t)bytes[i + 1] << 8 | bytes[i + 2];
        for (int k = 18; k >= 0; k -= 6) base64[n++] = digits[w >> k & 63];
    }
    base64[n] = 0;
    n = (size_t)snprintf(out, size,
                         "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[");
    for (int i = 0; i < depth; i++)
        n += (size_t)snprintf(out + n, size - n, "{\"name\":\"n%d\",\"translation\":[1,0,0]%s,\"%s\":%s%d%s},", i,
                              i == 0 ? ",\"scale\":[-1,1,1]" : "", i + 1 < depth ? "children" : "mesh",
                              i + 1 < depth ? "[" : "", i + 1 < depth ? i + 1 : 0, i + 1 < depth ? "]" : "");
    n--;
    n += (size_t)snprintf(
        out + n, size - n,
        "],\"materials\":[{\"name\":\"skin\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.06,0.06,0.06,1]}}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":0}]}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],"
        "\"max\":[1,1,1]},{\"bufferView\":1,\"componentType\":5123,\"count\":12,\"type\":\"SCALAR\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,"
        "\"byteLength\":24}],\"buffers\":[{\"byteLength\":72,\"uri\":\"data:application/octet-stream;base64,%s\"}]}",
        base64);
    CHECK(n < size);
    return n;
}

static void nodes_compose_and_mirrors_turn_nothing_inside_out(void **state)
{
    (void)state;
    static char text[1 << 16];
    char        path[128], yaml[128];
    Model       m;
    ModelImport r;
    write_file(path, "chain.gltf", text, make_gltf(text, sizeof text, 3));
    write_text(yaml, "chain.yaml", "origin: 0 0 0\njoints:\n- {nodes: n1, axis: +y}\n");
    assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
    /* x = 1 - (1 + 1 + 0 .. 1) = -2 .. -1 in the file, whose +x is left: 1 .. 2 m to the right */
    CHECK(m.box_low[1] == 1 && m.box_high[1] == 2 && m.box_high[0] == 1 && m.box_low[2] == -1);
    CHECK(r.edges.open == 0 && r.edges.inside_out_parts == 0);
    assert_int_equal(model_validate(&m), STATUS_OK);
    /* n1 stands at x = 0 in the file, turns about up; n0 and n2 are drawn into what they ride on */
    assert_int_equal(m.node_count, 2);
    CHECK(v3_length(m.node[1].p_parent) == 0 && m.node[1].axis[2] == -1 && m.part[0].node == 1);
    assert_string_equal(m.part[0].material, "rubber_black"); /* nearest to 6 % grey of paints and bare things */
    CHECK(r.material_parts[MATERIAL_BY_COLOUR] == 1);
    model_destroy(&m);

    write_file(path, "deep.gltf", text, make_gltf(text, sizeof text, 256));
    assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
    model_destroy(&m);
    write_file(path, "deep.gltf", text, make_gltf(text, sizeof text, 257));
    refused(path, STATUS_BAD_VALUE, "more than 256 levels");
}

/* Some octets changed, cut or repeated: a status, a line for a failure, and a sound model otherwise; never a crash. */
static void turned_octets_never_crash(void **state)
{
    (void)state;
    static char    text[1 << 14], spoilt[1 << 15];
    const uint32_t key[2] = {77, 0};
    int            failed = 0, read = 0;
    for (int round = 0; round < 300; round++) {
        const bool gltf = round % 2;
        size_t     size = gltf ? make_gltf(text, sizeof text, 4) : strlen(BLOCK);
        char       path[128];
        memcpy(spoilt, gltf ? text : BLOCK, size);
        for (uint32_t change = 0; change < 1 + (uint32_t)round % 3; change++) {
            uint32_t word[4];
            random_u32x4(word, (const uint32_t[4]){(uint32_t)round, change, 0, 0}, key);
            size_t       at = word[0] % size;
            const size_t octets = 1 + word[1] % 9;
            switch (word[2] % 8) {
            case 0:
                spoilt[at] = (char)word[3];
                break;
            case 1:
                size = at > size / 2 ? at + 1 : size;
                break;
            case 2:
                if (at + octets >= size) break;
                memmove(spoilt + at, spoilt + at + octets, size - at - octets);
                size -= octets;
                break;
            default: /* another number: still the format, no longer the sense */
                while (at < size && !(spoilt[at] >= '0' && spoilt[at] <= '9')) at++;
                if (at < size) spoilt[at] = "0123456789-.e"[word[3] % 13];
            }
        }
        write_file(path, gltf ? "spoilt.gltf" : "spoilt.obj", spoilt, size);
        Model m;
        if (import_quietly(&m, NULL, path) == STATUS_OK) {
            read++;
            assert_int_equal(model_check(&m), STATUS_OK);
            model_destroy(&m);
        } else {
            failed++;
            CHECK(check_said[0] && !strchr(check_said, '\n'));
        }
    }
    printf("%d read, %d refused\n", read, failed);
    CHECK(read > 20 && failed > 20);
}

/* Of a block 2 x 4 x 6 with x forward and z up, turning about its middle to the left, the corners are sqrt(1 + 9) units
 * from the axis: `roll_radius: auto` is that times the scale, of whatever scale the sidecar gives or leaves to the file
 * (a unit is a metre). A radius that is given is in metres whatever the scale, and a limit of what slides too; a pivot
 * is in the file's units. */
static void what_scales_with_a_model(void **state)
{
    (void)state;
    static const struct {
        const char *scale;
        double      scale_m;
    } c[] = {{"scale: 0.5\n", 0.5}, {"scale: 3\n", 3}, {"", 1}};
    char path[128], yaml[128], text[512];
    write_text(path, "wheel.obj", BLOCK);
    for (size_t i = 0; i < sizeof c / sizeof *c; i++)
        for (int kind = 0; kind < 3; kind++) {
            static const char *const joint[] = {
                "pivot: centre, roll_radius: auto", "pivot: 1 1 3, roll_radius: 0.25",
                "pivot: 1 1 3, axis: up, class: 2048, metric: extension, limits_m: -1 2"};
            Model       m;
            ModelImport r;
            snprintf(text, sizeof text, "%saxes: +x +z\norigin: 0 0 0\njoints:\n  - {name: w, nodes: block, %s}\n",
                     c[i].scale, joint[kind]);
            write_text(yaml, "wheel.yaml", text);
            assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
            const ModelNode *w = &m.node[node_called(&m, "w")];
            const double     s = c[i].scale_m;
            CHECK_NEAR(w->roll_radius_m, kind == 0 ? s * sqrt(10) : kind == 1 ? 0.25 : 0, 1e-12);
            if (kind == 2) CHECK(w->joint == JOINT_TRANSLATION && w->low == -1 && w->high == 2);
            /* y of the file is left, z up */
            CHECK_NEAR(w->p_parent[0], s * 1, 1e-12);
            CHECK_NEAR(w->p_parent[1], s * (kind == 0 ? -2 : -1), 1e-12);
            CHECK_NEAR(w->p_parent[2], s * -3, 1e-12);
            CHECK_NEAR(m.box_high[0], s * 2, 1e-12);
            CHECK_NEAR(m.box_low[1], s * -4, 1e-12);
            CHECK_NEAR(m.box_low[2], s * -6, 1e-12);
            CHECK_NEAR(m.length_m, s * 2, 1e-12);
            model_destroy(&m);
        }
    remove(yaml);
}

/* ---- models of other people --------------------------------------------------------------------------------- */

static bool ktank(char yaml[128], const char *name)
{
    char mesh[512], text[2048];
    if (!reference_path(mesh, "models/brlcad/ktank.obj")) return false;
    CHECK((mesh[0] == '/' ? mesh : realpath(mesh, text)) != NULL);
    char whole[512];
    snprintf(whole, sizeof whole, "%.511s", mesh[0] == '/' ? mesh : text);
    snprintf(text, sizeof text,
             "file: %s\nname: K-Tank\naxes: +x +z\n"
             "drop: [tank/driver/*, tank/turret/commander/*, tank/turret/gunner/*, tank/turret/loader/*]\n"
             "joints:\n"
             "  - {name: turret, nodes: tank/turret/*, class: primary_turret_1, metric: azimuth, pivot: 0 0 0}\n"
             "  - {name: gun, parent: turret, nodes: tank/turret/gun/*, pivot: 0.254 0 0.127, rest_deg: 15,\n"
             "     class: primary_gun_1, metric: elevation, limits_deg: -10 20}\n"
             "  - {nodes: tank/wheels/*, each: true, pivot: centre, roll_radius: auto}\n"
             "materials: {'*': paint_olive}\nnode_materials: {tank/wheels/*: rubber_black}\n"
             "roles: {'tank/fuel/*': hull}\n"
             "damage: {destroyed: {hide: ['tank/turret/gun/*'], materials: {'*': metal_dark}}}\n",
             whole);
    write_text(yaml, name, text);
    return true;
}

/* From the solids (models/brlcad/README.md): trunnion at (0.254, 0, 0.127), the barrel 5.08 m long and raised by 15
 * degrees, road wheels of radius 0.381 m with axles at z = -1.168, five a side from x = 1.854 on. */
static void ktanks_joints_are_where_its_solids_say(void **state)
{
    (void)state;
    char        yaml[128];
    Model       m;
    ModelImport r;
    double      low[3], high[3], value[64] = {0};
    if (!ktank(yaml, "k.yaml")) {
        skip();
        return;
    }
    assert_int_equal(import_quietly(&m, &r, yaml), STATUS_OK);
    CHECK(check_said[0] == 0); /* every pattern matches */
    assert_string_equal(m.name, "K-Tank");
    CHECK(m.node_count == 1 + 2 + 14 && r.edges.open == 0 && r.dropped_meshes == 40);
    const int turret = node_called(&m, "turret"), gun = node_called(&m, "gun"),
              wheel = node_called(&m, "tank/wheels/r32");
    const ModelPart *barrel = part_called(&m, "tank/turret/gun/r210");
    CHECK(m.node[gun].parent == turret && barrel->node == gun && m.node[gun].dis_class == 4416 &&
          m.node[gun].dis_metric == 13);
    CHECK_NEAR(m.node[gun].p_parent[0], 0.254, 1e-12);
    CHECK_NEAR(m.node[gun].p_parent[2], -0.127, 1e-12);
    CHECK_NEAR(m.node[wheel].roll_radius_m, 0.381, 0.001); /* the mesh's tolerance */
    CHECK_NEAR(m.node[wheel].p_parent[0] - m.node[turret].p_parent[0], 1.854, 0.001);
    CHECK_NEAR(m.node[wheel].p_parent[2], -0.381, 0.001); /* it stands on the ground */
    CHECK_NEAR(m.box_high[2], 0, 1e-12);
    assert_string_equal(part_called(&m, "tank/wheels/r32")->material, "rubber_black");
    CHECK(part_called(&m, "tank/wheels/r32")->role == HEAT_WHEEL &&
          part_called(&m, "tank/fuel/r23")->role == HEAT_HULL);

    /* at 0 the barrel is level and points forward */
    const double trunnion_x = m.node[turret].p_parent[0] + 0.254, trunnion_z = m.node[turret].p_parent[2] - 0.127;
    part_box(low, high, &m, barrel, value);
    const double radius = 0.5 * (high[1] - low[1]);
    CHECK(radius < 0.1);
    CHECK_NEAR(high[0] - trunnion_x, 5.08, 0.002);
    CHECK_NEAR(0.5 * (low[2] + high[2]), trunnion_z, 0.001);
    CHECK_NEAR(0.5 * (high[2] - low[2]), radius, 0.001);
    /* azimuth 90: to the right; elevation 15 then lifts the tip by 5.08 sin 15 */
    value[turret] = 90 * rad_per_deg;
    value[gun] = 15 * rad_per_deg;
    part_box(low, high, &m, barrel, value);
    CHECK_NEAR(high[1], 0.254 + 5.08 * cos(15 * rad_per_deg) + radius * sin(15 * rad_per_deg), 0.002);
    CHECK_NEAR(low[2] - trunnion_z, -5.08 * sin(15 * rad_per_deg) - radius * cos(15 * rad_per_deg), 0.002);
    /* the limit holds */
    value[gun] = 80 * rad_per_deg;
    part_box(low, high, &m, barrel, value);
    CHECK_NEAR(low[2] - trunnion_z, -5.08 * sin(20 * rad_per_deg) - radius * cos(20 * rad_per_deg), 0.002);

    CHECK(barrel->damage_hidden == 1 << 3 && part_called(&m, "tank/hull/r1")->damage_hidden == 0);
    assert_string_equal(part_called(&m, "tank/hull/r1")->damage_material[3], "metal_dark");
    CHECK(part_called(&m, "tank/hull/r1")->damage_material[1][0] == 0);
    model_destroy(&m);
}

/* models/free/README.md: T54_Tank > Joint_Turret (0, 1.30, -0.30) > Joint_MainGun (0, 1.45, -1.40), faces -Z, 3.48 x
 * 2.10 x 9.01 m. */
static void a_gltf_hierarchy_gives_its_own_pivots(void **state)
{
    (void)state;
    char        mesh[512], whole[4096], text[4600], yaml[128];
    Model       m;
    ModelImport r;
    if (!reference_path(mesh, "models/free/t-54-main-battle.glb")) {
        skip();
        return;
    }
    CHECK(realpath(mesh, whole) != NULL);
    snprintf(text, sizeof text,
             "file: %s\naxes: -z +y\njoints:\n"
             "  - {name: turret, nodes: Joint_Turret, class: primary_turret_1, metric: azimuth}\n"
             "  - {name: gun, nodes: Joint_MainGun, class: primary_gun_1, metric: elevation, limits_deg: -5 18}\n",
             whole);
    write_text(yaml, "t54.yaml", text);
    assert_int_equal(import_quietly(&m, &r, yaml), STATUS_OK);
    CHECK_NEAR(m.length_m, 9.01, 0.005); /* the README's rounding */
    CHECK_NEAR(m.width_m, 3.48, 0.005);
    CHECK_NEAR(m.height_m, 2.10, 0.005);
    assert_int_equal(m.node_count, 3);
    /* the file's own numbers are single precision, and so is the turn of its root */
    CHECK_NEAR(m.node[2].p_parent[0], 1.10, 2e-6);
    CHECK_NEAR(m.node[2].p_parent[1], 0, 2e-6);
    CHECK_NEAR(m.node[2].p_parent[2], -0.15, 2e-6);
    CHECK_NEAR(m.node[1].p_parent[2], -(1.30 - r.p_origin_file[1]), 2e-6);
    CHECK_NEAR(m.node[1].p_parent[0], 0.30 + r.p_origin_file[2], 2e-6);
    CHECK(r.lost[LOST_TEXTURES] > 0);
    model_destroy(&m);
}

static void a_catalog_names_files(void **state)
{
    (void)state;
    char     path[128], yaml[128];
    Catalog *c = NULL;
    write_text(path, "mine.obj", BLOCK);
    write_text(path, "catalog.csv",
               "type,model,origin\n1.1.222.1,mine.obj,base\n1.1.222.2,tank,base\n1.1.222.3,mine.obj,base\n");
    assert_int_equal(catalog_open(&c, path, 0.02), STATUS_OK);
    assert_int_equal(catalog_model_count(c), 3); /* unknown, the block once, the tank */
    const int block = catalog_find(c, (DisEntityType){1, 1, 222, 1, 0, 0, 0}, NULL, NULL);
    CHECK(catalog_model(c, block)->length_m == 6);
    assert_int_equal(catalog_find(c, (DisEntityType){1, 1, 222, 3, 0, 0, 0}, NULL, NULL), block);
    catalog_close(c);
    if (ktank(yaml, "absolute.yaml")) {
        char text[400];
        snprintf(text, sizeof text, "type,model,origin\n1.1,%s,base\n", yaml);
        write_text(path, "catalog.csv", text);
        assert_int_equal(catalog_open(&c, path, 0.02), STATUS_OK);
        assert_string_equal(catalog_model(c, catalog_find(c, (DisEntityType){1, 1, 0, 0, 0, 0, 0}, NULL, NULL))->name,
                            "K-Tank");
        catalog_close(c);
    }
    write_text(path, "catalog.csv", "type,model,origin\n1.1,none.glb,base\n");
    log_set_sink(check_listen, NULL);
    assert_int_equal(catalog_open(&c, path, 0.02), STATUS_IO);
    CHECK(strstr(check_said, "line=2") && strstr(check_said, "none.glb"));
    log_set_sink(NULL, NULL);
}

/* ---- OpenFlight ------------------------------------------------------------------------------------------------ */

/* Big-endian records of the OpenFlight 15.8 specification, one after the other. */
typedef struct Flt {
    uint8_t at[1 << 16];
    size_t  count, record;
    double  vertex[64][3];
    int     vertices;
} Flt;

static void put_bytes(Flt *f, size_t offset, uint64_t value, int octets)
{
    for (int i = 0; i < octets; i++) f->at[f->record + offset + (size_t)i] = (uint8_t)(value >> 8 * (octets - 1 - i));
}

static void put_double(Flt *f, size_t offset, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_bytes(f, offset, bits, 8);
}

static void record(Flt *f, int opcode, size_t length, const char *id)
{
    f->record = f->count;
    f->count += length;
    CHECK(f->count <= sizeof f->at);
    memset(f->at + f->record, 0, length);
    put_bytes(f, 0, (uint64_t)opcode, 2);
    put_bytes(f, 2, length, 2);
    if (id) memcpy(f->at + f->record + 4, id, strlen(id));
}

static void push(Flt *f) { record(f, 10, 4, NULL); }
static void pop(Flt *f) { record(f, 11, 4, NULL); }

/* A tetrahedron of corner s at (x, y, z), below an object. */
static void tetrahedron(Flt *f, const char *name, double x, double y, double z, double s)
{
    static const int face[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const double     corner[4][3] = {{x, y, z}, {x + s, y, z}, {x, y + s, z}, {x, y, z + s}};
    const int        first = f->vertices;
    memcpy(f->vertex[first], corner, sizeof corner);
    f->vertices += 4;
    record(f, 4, 28, name);
    push(f);
    for (int i = 0; i < 4; i++) {
        record(f, 5, 80, "face");
        for (size_t at = 26; at < 32; at += 2) put_bytes(f, at, 0xffff, 2); /* no detail, texture, material */
        put_bytes(f, 44, 0x10000000, 4);                                    /* packed colour: a, b, g, r */
        put_bytes(f, 56, 0xff204060, 4);
        put_bytes(f, 64, 0xffff, 2);
        push(f);
        record(f, 72, 16, NULL);
        for (int k = 0; k < 3; k++) put_bytes(f, 4 + 4 * (size_t)k, 8 + 40 * (size_t)(first + face[i][k]), 4);
        pop(f);
    }
    pop(f);
}

/* Degree of freedom at (x, y, z): its x axis along xd, yd; angles in degrees; flags as the specification's, bit 0
 * highest. */
static void freedom(Flt *f, const char *name, const double p[3], double xd, double yd, double pitch_low,
                    double pitch_high, double yaw_low, double yaw_high, uint32_t flags)
{
    record(f, 14, 384, name);
    for (size_t i = 0; i < 3; i++) {
        put_double(f, 16 + 8 * i, p[i]);
        put_double(f, 40 + 8 * i, p[i] + (i == 0 ? xd : i == 1 ? yd : 0));
        put_double(f, 64 + 8 * i, p[i] + (i == 0 ? -yd : i == 1 ? xd : 0));
    }
    put_double(f, 184, pitch_low);
    put_double(f, 192, pitch_high);
    put_double(f, 248, yaw_low);
    put_double(f, 256, yaw_high);
    for (size_t axis = 0; axis < 3; axis++)
        for (size_t i = 0; i < 3; i++) put_double(f, 280 + 32 * axis + 8 * i, 1); /* scales: least, most, now */
    put_bytes(f, 376, flags, 4);
}

static void level(Flt *f, const char *name, double in_m, double out_m)
{
    record(f, 73, 80, name);
    put_double(f, 16, in_m);
    put_double(f, 24, out_m);
}

/* hull; turret with yaw -30 .. 170 degrees about (0, 0.5, 1.5), on it a gun with pitch -5 .. 20 about (0, 1.5, 2), and
 * a mast that turns freely about an axis of its own; and a stone in two levels of detail. */
static void make_flt(Flt *out)
{
    static Flt f;
    f = (Flt){0};
    record(&f, 2, 44, "g");
    push(&f);
    tetrahedron(&f, "hull", -1, -1, 0, 4);
    freedom(&f, "turret", (const double[3]){0, 0.5, 1.5}, 1, 0, 0, 0, -30, 170, 1u << 26);
    push(&f);
    tetrahedron(&f, "dome", 0, 0, 1.5, 1);
    freedom(&f, "gun", (const double[3]){0, 1.5, 2}, 1, 0, -5, 20, 0, 0, 1u << 28);
    push(&f);
    tetrahedron(&f, "tube", 0, 1.5, 2, 0.5);
    pop(&f);
    freedom(&f, "mast", (const double[3]){0, 0, 3}, 0, 1, -180, 180, 0, 0, 0);
    push(&f);
    tetrahedron(&f, "pole", 0, 0, 3, 0.25);
    pop(&f);
    pop(&f);
    level(&f, "near", 100, 0);
    push(&f);
    tetrahedron(&f, "stone", 3, 0, 0, 0.5);
    pop(&f);
    level(&f, "far", 5000, 100);
    push(&f);
    tetrahedron(&f, "pebble", 3, 0, 0, 0.25);
    pop(&f);
    pop(&f);

    *out = (Flt){0};
    record(out, 1, 324, "db");
    put_bytes(out, 12, 1580, 4);
    record(out, 67, 8, NULL);
    put_bytes(out, 4, 8 + 40 * (size_t)f.vertices, 4);
    for (int v = 0; v < f.vertices; v++) {
        record(out, 68, 40, NULL);
        put_bytes(out, 6, 0x1000, 2); /* packed colour */
        for (size_t i = 0; i < 3; i++) put_double(out, 8 + 8 * i, f.vertex[v][i]);
        put_bytes(out, 32, 0xff204060, 4);
    }
    push(out);
    CHECK(out->count + f.count + 4 <= sizeof out->at);
    memcpy(out->at + out->count, f.at, f.count);
    out->count += f.count;
    pop(out);
}

static void openflights_freedoms_are_joints(void **state)
{
    (void)state;
    static Flt  flt;
    char        path[128];
    Model       m;
    ModelImport r;
    if (system("command -v osgconv >/dev/null") != 0) {
        printf("skipped: no osgconv (apt-get install openscenegraph)\n");
        skip();
        return;
    }
    make_flt(&flt);
    write_file(path, "tank.flt", flt.at, flt.count);
    assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
    assert_int_equal(m.node_count, 4);
    assert_int_equal(r.joints_from_file, 3);
    assert_int_equal(r.lost[LOST_LEVELS_OF_DETAIL], 1);
    const int turret = node_called(&m, "turret"), gun = node_called(&m, "gun"), mast = node_called(&m, "mast");
    CHECK(m.node[gun].parent == turret && m.node[mast].parent == turret);
    CHECK(part_called(&m, "dome")->node == turret && part_called(&m, "tube")->node == gun);
    CHECK(part_called(&m, "stone")->node == 0 && m.part_count == 5);
    /* OpenFlight: y forward, x right, z up. Yaw is counter-clockwise from above, DIS's azimuth clockwise */
    CHECK(m.node[turret].dis_class == 4096 && m.node[turret].dis_metric == 11 &&
          m.node[turret].joint == JOINT_ROTATION);
    CHECK_NEAR(m.node[turret].axis[2], 1, 1e-12);
    CHECK_NEAR(m.node[turret].low, -170 * rad_per_deg, 1e-6); /* kept as float on the way */
    CHECK_NEAR(m.node[turret].high, 30 * rad_per_deg, 1e-6);
    CHECK(m.node[gun].dis_class == 4416 && m.node[gun].dis_metric == 13);
    CHECK_NEAR(m.node[gun].axis[1], 1, 1e-12); /* up is positive in both */
    CHECK_NEAR(m.node[gun].low, -5 * rad_per_deg, 1e-6);
    CHECK_NEAR(m.node[gun].high, 20 * rad_per_deg, 1e-6);
    CHECK_NEAR(m.node[gun].p_parent[0], 1, 1e-9);
    CHECK_NEAR(m.node[gun].p_parent[2], -0.5, 1e-9);
    /* unlimited, about its own x axis, which lies forward */
    CHECK(m.node[mast].low > m.node[mast].high && m.node[mast].dis_class == 0);
    CHECK_NEAR(m.node[mast].axis[0], 1, 1e-9);
    /* raised by 20 degrees the tube's far corner, 0.5 m ahead of the trunnion, is 0.5 sin 20 higher than level; the
     * corner above the trunnion turns back */
    double low[3], high[3], value[4] = {0};
    value[gun] = 20 * rad_per_deg;
    part_box(low, high, &m, part_called(&m, "tube"), value);
    CHECK_NEAR(high[0] - low[0], 0.5 * cos(20 * rad_per_deg) + 0.5 * sin(20 * rad_per_deg), 1e-6);
    assert_int_equal(model_validate(&m), STATUS_OK);
    const double length_m = m.length_m;
    model_destroy(&m);

    /* the same drawn in feet: octet 62 of the header */
    static Flt feet;
    feet = flt;
    feet.at[62] = 4;
    write_file(path, "feet.flt", feet.at, feet.count);
    assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
    CHECK_NEAR(m.length_m, 0.3048 * length_m, 1e-5);
    CHECK(strstr(r.unit_from, "header") && r.scale_m == 1);
    model_destroy(&m);
    write_file(path, "tank.flt", flt.at, flt.count);

    /* the sidecar has the last word, and keeps the file's pivot */
    char yaml[128];
    write_text(yaml, "tank.yaml",
               "joints:\n- {nodes: mast, class: primary_radar_1, metric: rotation, limits_deg: -90 90}\n");
    assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
    const int radar = node_called(&m, "mast");
    CHECK(m.node_count == 4 && m.node[radar].dis_class == 5376 && m.node[radar].dis_metric == 15);
    CHECK_NEAR(m.node[radar].high, pi_rad / 2, 1e-12);
    CHECK_NEAR(m.node[radar].p_parent[2], -1.5, 1e-9);
    model_destroy(&m);

    /* an external reference, or a texture, at an address: nothing is fetched */
    for (int opcode = 63; opcode <= 64; opcode++) {
        static Flt far;
        far = flt;
        record(&far, opcode, 216, "http://127.0.0.1:9/far.flt");
        write_file(path, "far.flt", far.at, far.count);
        refused(path, STATUS_BAD_VALUE, "http://127.0.0.1:9/far.flt");
        memcpy(far.at + far.record + 4, "there/is/none/of/this.flt\0", 27);
        write_file(path, "near.flt", far.at, far.count);
        assert_int_equal(import_quietly(&m, &r, path), STATUS_OK);
        model_destroy(&m);
    }

    write_file(path, "cut.flt", flt.at, 300);
    refused(path, STATUS_BAD_VALUE, "cut.flt");
    write_file(path, "not.flt", "hello", 5);
    refused(path, STATUS_BAD_VALUE, "not.flt");
}

static void without_osgconv_the_next_step_is_said(void **state)
{
    (void)state;
    char       path[128];
    char      *was = strdup(getenv("PATH"));
    static Flt flt;
    make_flt(&flt);
    write_file(path, "lonely.flt", flt.at, flt.count);
    setenv("PATH", folder, 1);
    refused(path, STATUS_IO, "apt-get install openscenegraph");
    setenv("PATH", was, 1);
    free(was);
}

static int make_folder(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/pitviper-import-XXXXXX");
    return mkdtemp(folder) ? 0 : 1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_lies_as_its_axes_say),
        cmocka_unit_test(what_is_odd_is_counted_and_what_is_broken_refused),
        cmocka_unit_test(nodes_compose_and_mirrors_turn_nothing_inside_out),
        cmocka_unit_test(turned_octets_never_crash),
        cmocka_unit_test(what_scales_with_a_model),
        cmocka_unit_test(ktanks_joints_are_where_its_solids_say),
        cmocka_unit_test(a_gltf_hierarchy_gives_its_own_pivots),
        cmocka_unit_test(a_catalog_names_files),
        cmocka_unit_test(openflights_freedoms_are_joints),
        cmocka_unit_test(without_osgconv_the_next_step_is_said),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
