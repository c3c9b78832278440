/* Signatures on disk: what is read has the bits of what was made; files that are damaged, cut or of another name are
 * refused and made anew; other settings, poses and models have other names. labels: physics */
#include "tests/sensor/signature_files.h"

static Got plain, first, again, other;

static void a_file_has_the_bits_of_its_making(void **state)
{
    (void)state;
    look(&plain, 30, NULL, 1e-3, false);
    look(&first, 30, NULL, 1e-3, true);
    CHECK(first.counters.made == 1 && first.counters.fetched == 0 && first.files.written == 1 &&
          empty_folder(false) == 1);
    look(&again, 30, NULL, 1e-3, true);
    CHECK(again.counters.made == 0 && again.counters.fetched == 1 && again.files.written == 0);
    CHECK(same(&plain, &first) && same(&plain, &again));
    printf("a truck at 5 GHz: %d centres, %.0f kB\n", plain.count, 1e-3 * (double)first.files.octets);
}

static void an_entry_of_the_cache_has_them_too(void **state)
{
    char room[temp_path_size], command[temp_path_size + 16];
    (void)state;
    CHECK(temp_folder(room) && (cache = cache_open(room, 64 << 20)));
    look(&first, 30, NULL, 1e-3, true);
    look(&again, 30, NULL, 1e-3, true);
    look(&other, 31, NULL, 1e-3, true);
    CHECK(first.counters.made == 1 && again.counters.made == 0 && again.counters.fetched == 1);
    CHECK(other.counters.made == 1 && same(&plain, &first) && same(&plain, &again));
    CHECK(cache_counters(cache).made == 2 && cache_counters(cache).fetched == 1 && empty_folder(false) == 1);
    cache_close(cache);
    cache = NULL;
    snprintf(command, sizeof command, "rm -r '%s'", room);
    CHECK(system(command) == 0);
}

static void names_follow_from_all_that_counts(void **state)
{
    (void)state;
    static double joint[512];
    const Model  *of = catalog_model(catalog, model);
    int           files = empty_folder(false);
    look(&other, 31, NULL, 1e-3, true);
    CHECK(other.counters.made == 1 && empty_folder(false) == ++files);
    look(&other, 30, NULL, 2e-3, true);
    CHECK(other.counters.made == 1 && empty_folder(false) == ++files);
    int turned = -1;
    for (int n = 1; n < of->node_count; n++)
        if (of->node[n].roll_radius_m == 0) turned = n;
        else joint[n] = 1;
    look(&other, 30, joint, 1e-3, true); /* wheels alone: the same */
    CHECK(other.counters.fetched == 1 && same(&other, &plain));
    if (turned >= 0) {
        joint[turned] = 0.2;
        look(&other, 30, joint, 1e-3, true);
        CHECK(other.counters.made == 1 && empty_folder(false) == ++files);
    }
}

/* What a checksum cannot tell: centres that no computation gives, in a file that is whole. */
static void numbers_are_checked(void **state)
{
    (void)state;
    char            key[sha256_text_size];
    static uint8_t  octets[4096];
    SignatureCentre centre[2] = {
        {.path = 3,
         .path_share = 0.5f,
         .scale = 1,
         .moment_scale = 1,
         .weight = 2,
         .strongest = 1,
         .part = 1,
         .bounce = 1},
        {.path = -7, .path_share = 0, .scale = 0, .moment_scale = 0, .weight = 2, .strongest = 2}};
    const SignatureCentre good[2] = {centre[0], centre[1]};
    memset(key, 'a', sizeof key - 1);
    key[sizeof key - 1] = 0;
    for (int i = 0; i < 12; i++) {
        memcpy(centre, good, sizeof good);
        Signature to = {.count = 2, .centre = centre}, from = {0};
        switch (i) {
        case 1:
            centre[0].p[1] = NAN;
            break;
        case 2:
            centre[1].half[2] = INFINITY;
            break;
        case 3:
            centre[0].weight = -1;
            break;
        case 4:
            centre[0].part = 2;
            break;
        case 5:
            centre[1].path_share = 1.5f;
            break;
        case 6:
            centre[0].scale = NAN;
            break;
        case 7:
            centre[0].strongest = 3;
            break;
        case 8:
            centre[0].zero = 1;
            break;
        case 9:
            centre[0].path = INT32_MIN;
            break;
        case 10:
            centre[0].moment_scale = INFINITY;
            break;
        default:
            break;
        }
        const size_t count = signature_to_octets(octets, &to, key);
        CHECK(count == 96 + 2 * 84 + 64);
        const Status status = signature_from_octets(&from, octets, count, key, 2);
        CHECK(status == (i == 0 || i == 11 ? STATUS_OK : STATUS_BAD_VALUE));
        if (status == STATUS_OK) CHECK(from.count == 2 && memcmp(from.centre, good, sizeof good) == 0);
        signature_free(&from);
    }
}

/* A model of two nodes, two parts and one triangle, for its hash alone. */
typedef struct SmallModel {
    Model     model;
    ModelNode node[2];
    ModelPart part[2];
    double    vertex[3][3];
    float     normal[3][3];
    uint32_t  triangle[1][3];
    uint16_t  triangle_part[1];
} SmallModel;

static void small_model(SmallModel *m)
{
    *m = (SmallModel){
        .model = {.name = "small", .node_count = 2, .part_count = 2, .vertex_count = 3, .triangle_count = 1},
        .node = {{.parent = -1, .axis = {0, 0, 1}, .r_parent_from_node = {1, 0, 0, 0, 1, 0, 0, 0, 1}},
                 {.joint = JOINT_ROTATION, .axis = {0, 0, 1}, .r_parent_from_node = {1, 0, 0, 0, 1, 0, 0, 0, 1}}},
        .part = {{.material = "paint", .triangle_count = 1}, {.node = 1, .material = "paint"}},
        .vertex = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        .normal = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
        .triangle = {{0, 1, 2}}};
    m->model.node = m->node, m->model.part = m->part, m->model.vertex = m->vertex, m->model.normal = m->normal;
    m->model.triangle = m->triangle, m->model.triangle_part = m->triangle_part;
}

/* Whether a library of these settings, opened anew, has the signature. */
static bool has(const SignaturesConfig *config, const RadarMaterials *of, const SignatureKey *key)
{
    SignatureLibrary *library;
    CHECK(signature_library_open(&library, folder, config, of) == STATUS_OK);
    const bool there = signature_library_has(library, key);
    signature_library_close(library);
    return there;
}

/* Changes the lowest bit of a member: of what follows from that the library has nothing. */
#define CHECK_NAMED(member)                                                                                            \
    do {                                                                                                               \
        unsigned char *octet = (unsigned char *)&(member);                                                             \
        CHECK(has(&config, &two, &key));                                                                               \
        *octet ^= 1;                                                                                                   \
        if (has(&config, &two, &key)) fail_msg("%s:%d: %s is not in the name", __FILE__, __LINE__, #member);           \
        *octet ^= 1;                                                                                                   \
    } while (0)

/* Every member that a signature follows from, changed alone by its lowest bit: the look, the pose, the damage, the
 * settings, the materials, the model. */
static void each_member_is_in_the_name(void **state)
{
    (void)state;
    SmallModel       m;
    SignaturesConfig config = config_of(1e-3);
    RadarMaterial    material[3] = {{.name = "paint",
                                     .kind = RADAR_COATED,
                                     .thick_m = 1e-3,
                                     .rough_m = 1e-4,
                                     .points = 2,
                                     .frequency_hz = {1e9, 9e9},
                                     .e1 = {3, 4},
                                     .e2 = {0.1, 0.2}},
                                    {.name = "steel"}};
    RadarMaterials   two = {2, material};
    double           joint[2] = {0, 0.25};
    SignatureKey     key = {
            .model = &m.model,
            .joint = joint,
            .damage = 2,
            .look = {
                .tx = {{0, 0, -1}, 2000}, .rx = {{0, 0, -1}, 2000}, .image = {false, true}, .plane = {{0, 0, -1}, 0.5}}};
    SignatureCentre   centre = {.path = 3, .scale = 1, .weight = 2, .strongest = 1};
    const Signature   one = {.count = 1, .centre = &centre};
    SignatureLibrary *library;
    small_model(&m);
    config.interval_s = 0.01, config.splits = 1;
    CHECK(signature_library_open(&library, folder, &config, &two) == STATUS_OK);
    const SignatureStore store = signature_library_store(library);
    store.keep(store.user, &one, &key);
    signature_library_close(library);

    CHECK_NAMED(key.damage);
    for (int i = 0; i < 2; i++) {
        CHECK_NAMED(key.look.image[i]);
        CHECK_NAMED(joint[i]);
    }
    for (int x = 0; x < 3; x++) {
        CHECK_NAMED(key.look.tx.u[x]);
        CHECK_NAMED(key.look.rx.u[x]);
        CHECK_NAMED(key.look.plane.n[x]);
    }
    CHECK_NAMED(key.look.tx.range_m);
    CHECK_NAMED(key.look.rx.range_m);
    CHECK_NAMED(key.look.plane.height_m);

    CHECK_NAMED(config.frequency_hz);
    CHECK_NAMED(config.bandwidth_hz);
    CHECK_NAMED(config.aspect_rad);
    CHECK_NAMED(config.interval_s);
    CHECK_NAMED(config.rays_per_wavelength);
    CHECK_NAMED(config.splits);
    CHECK_NAMED(config.warp_m);

    CHECK_NAMED(two.count);
    for (int i = 0; i < 2; i++) {
        CHECK_NAMED(material[i].name[0]);
        CHECK_NAMED(material[i].kind);
        CHECK_NAMED(material[i].thick_m);
        CHECK_NAMED(material[i].rough_m);
        CHECK_NAMED(material[i].points);
        CHECK_NAMED(material[0].frequency_hz[i]);
        CHECK_NAMED(material[0].e1[i]);
        CHECK_NAMED(material[0].e2[i]);
    }

    CHECK_NAMED(m.model.name[0]);
    for (int n = 0; n < 2; n++) {
        CHECK_NAMED(m.node[n].parent);
        CHECK_NAMED(m.node[n].joint);
        CHECK_NAMED(m.node[n].low);
        CHECK_NAMED(m.node[n].high);
        CHECK_NAMED(m.node[n].roll_radius_m);
        CHECK_NAMED(m.node[n].spin_rps_moving); /* cells of what spins are as long as its range rates allow */
        for (int x = 0; x < 3; x++) CHECK_NAMED(m.node[n].p_parent[x]);
        for (int x = 0; x < 3; x++) CHECK_NAMED(m.node[n].axis[x]);
        for (int x = 0; x < 9; x++) CHECK_NAMED(m.node[n].r_parent_from_node[x]);
        CHECK_NAMED(m.part[n].node);
        CHECK_NAMED(m.part[n].material[0]);
        CHECK_NAMED(m.part[n].first_triangle);
        CHECK_NAMED(m.part[n].triangle_count);
        CHECK_NAMED(m.part[n].damage_hidden);
        for (int d = 0; d < model_damage_states; d++) CHECK_NAMED(m.part[n].damage_material[d][0]);
    }
    for (int i = 0; i < 3; i++) {
        for (int x = 0; x < 3; x++) {
            CHECK_NAMED(m.vertex[i][x]);
            CHECK_NAMED(m.normal[i][x]);
        }
        CHECK_NAMED(m.triangle[0][i]);
    }
    CHECK_NAMED(m.triangle_part[0]);
    empty_folder(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_has_the_bits_of_its_making), cmocka_unit_test(an_entry_of_the_cache_has_them_too),
        cmocka_unit_test(names_follow_from_all_that_counts), cmocka_unit_test(numbers_are_checked),
        cmocka_unit_test(each_member_is_in_the_name),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
