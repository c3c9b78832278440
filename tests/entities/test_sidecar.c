/* The sidecar: what is wrong is refused with file, line, key, value and what is accepted. */
#include "tests/check.h"

#include "entities/import/sidecar.h"

static Status parse(Sidecar *s, const char *text)
{
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = sidecar_parse(s, "tank.yaml", text, strlen(text));
    log_set_sink(NULL, NULL);
    return status;
}

static void every_key_arrives_in_si_units(void **state)
{
    (void)state;
    Sidecar s;
    char    word[32];
    assert_int_equal(
        parse(
            &s,
            "file: a.glb\nname: T-54\nscale: 0.0254\naxes: -z +Y\norigin: 1 2 -3.5\ncrease_deg: 45\n"
            "drop: [crew*, air]\n"
            "joints:\n"
            "  - {nodes: [t, u], name: turret, class: secondary_turret_3, metric: azimuth, pivot: [0, 0, 1]}\n"
            "  - {nodes: g, parent: turret, class: 4416, metric: elevation, limits_deg: -5 18, rest_deg: 15}\n"
            "  - {nodes: w*, each: true, pivot: centre, roll_radius: auto}\n"
            "  - {nodes: r, axis: 0 3 4, spin_rpm: 60}\n"
            "  - {nodes: m, axis: up, class: 2048, metric: extension, limits_m: 0 2}\n"
            "materials: {a: paint_olive}\nnode_materials: {w*: rubber_black}\nroles: {w*: wheel}\nthickness_mm: {w*: 12.5, hull: 1000}\n"
            "damage: {slight: {hide: x}, destroyed: {hide: [a, b], materials: {\"*\": metal_dark}}}\n"),
        STATUS_OK);
    assert_string_equal(s.file, "a.glb");
    assert_string_equal(s.name, "T-54");
    CHECK_NEAR(s.scale_m, 0.0254, 0);
    CHECK(s.has_axes && s.forward[2] == -1 && s.up[1] == 1 && v3_length(s.forward) == 1 && v3_length(s.up) == 1);
    CHECK(s.has_origin && s.p_origin_file[2] == -3.5);
    CHECK_NEAR(s.crease_rad, 0.7853981633974483, 1e-15);
    CHECK(s.drop.count == 2 && strcmp(s.drop.rule[0].pattern, "crew*") == 0 && s.drop.rule[1].line == 7);
    assert_int_equal(s.joint_count, 5);
    /* SISO-REF-010: secondary turret number 1 is 5696, each next one 32 on */
    CHECK(s.joint[0].dis_class == 5760 && s.joint[0].dis_metric == 11 && s.joint[0].pattern_count == 2);
    CHECK(s.joint[0].pivot == PIVOT_GIVEN && s.joint[0].p_pivot_file[2] == 1 && s.joint[0].line == 9);
    assert_string_equal(sidecar_class_text(word, 5760), "secondary_turret_3");
    CHECK(s.joint[1].dis_class == 4416 && s.joint[1].dis_metric == 13 && s.joint[1].pivot == PIVOT_NODE);
    CHECK_NEAR(s.joint[1].low, -0.08726646259971647, 1e-16);
    CHECK_NEAR(s.joint[1].rest, 0.2617993877991494, 1e-16);
    assert_string_equal(s.joint[1].parent, "turret");
    CHECK(s.joint[2].each && s.joint[2].pivot == PIVOT_CENTRE && s.joint[2].roll_radius_m < 0);
    CHECK_NEAR(s.joint[3].axis_xyz[2], 0.8, 1e-15);
    CHECK_NEAR(s.joint[3].spin_rps, 6.283185307179586, 1e-14);
    CHECK(s.joint[4].slides && s.joint[4].high == 2 && s.joint[4].axis == AXIS_BODY && s.joint[4].axis_xyz[2] == -1);
    CHECK(s.roles.count == 1 && s.materials.count == 1 && s.node_materials.count == 1);
    CHECK(s.thickness.count == 2 && strcmp(s.thickness.rule[0].value, "12.5") == 0 &&
          strcmp(s.thickness.rule[1].pattern, "hull") == 0);
    CHECK(s.damage_hide.count == 3 && s.damage_hide.rule[0].damage == 1 && s.damage_hide.rule[2].damage == 3);
    CHECK(s.damage_materials.count == 1 && s.damage_materials.rule[0].damage == 3);
    sidecar_close(&s);
    assert_int_equal(parse(&s, ""), STATUS_OK);
    CHECK(s.joint_count == 0 && !s.has_axes && s.scale_m == 0);
    CHECK_NEAR(s.crease_rad, pi_rad / 6, 1e-15);
    sidecar_close(&s);
}

static void what_is_wrong_is_said(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } bad[] = {
        {"scale: 1\nscael: 2\n", "tank.yaml:2: no such key: scael; did you mean scale?"},
        {"scale: 1\nscale: 2\n", "tank.yaml:2: scale is given twice"},
        {"scale: 0\n", "tank.yaml:1: scale: '0' is not a number in 1e-06 .. 1000000 metres a unit"},
        {"scale: 1,5\n", "scale: '1,5' is not a number"},
        {"scale: nan\n", "scale: 'nan' is not"},
        {"scale: [1]\n", "tank.yaml:1: scale needs one value"},
        {"origin: [1, 2, 3]\n", NULL}, /* a list of numbers is as good as numbers */
        {"scale: {a: 1}\n", "tank.yaml:1: scale needs one value"},
        {"axes: +x -x\n", "axes: '+x -x' is not two different of"},
        {"axes: forward up\n", "is not two different of"},
        {"axes: +x\n", "is not two different of"},
        {"origin: 1 2\n", "origin: '1 2' is not auto, or x y z"},
        {"origin: 1 2 3 4\n", "is not auto, or x y z"},
        {"crease_deg: 181\n", "in 0 .. 180 deg"},
        {"drop: {a: b}\n", "drop: '{...}' is not a pattern or a list"},
        {"drop: ['']\n", "is not a pattern of 1 .. 95 characters"},
        {"materials: [a]\n", "materials: '[...]' is not `pattern: name`"},
        {"materials: {a: b, a: c}\n", "tank.yaml:1: materials: 'a' is given twice"},
        {"materials: {a: 01234567890123456789012345678901}\n", "is not a name of 1 .. 31 characters"},
        {"roles:\n  a: hot\n", "tank.yaml:2: roles: 'hot' is not one of passive, hull, turret"},
        {"scale: 1\nthickness_mm: {\"hull*\": 0}\n",
         "tank.yaml:2: thickness_mm: '0' is not a thickness in 0.1 .. 1000 mm"},
        {"thickness_mm: {a: 1000.1}\n", "thickness_mm: '1000.1' is not a thickness in 0.1 .. 1000 mm"},
        {"thickness_mm: {a: -5}\n", "'-5' is not a thickness"},
        {"thickness_mm: {a: nan}\n", "'nan' is not a thickness"},
        {"thickness_mm: {a: thick}\n", "'thick' is not a thickness"},
        {"thickness_mm: {a: 5 6}\n", "'5 6' is not a thickness"},
        {"thickness_mm: 5\n", "thickness_mm: '5' is not `pattern: number` for each"},
        {"thickness_mm: {a: 5, a: 6}\n", "thickness_mm: 'a' is given twice"},
        {"thickness_mm: {a: 5.00000000000000000000000000000000001}\n", "is not a name of 1 .. 31 characters"},
        {"damage: {ruined: {}}\n", "tank.yaml:1: no such key: damage.ruined; all keys: `pitviper model --keys`"},
        {"damage: {slight: {burn: a}}\n", "no such key: damage.slight.burn; all keys"},
        {"damage: {slight: {hide: a}, slight: {hide: b}}\n", "damage.slight.hide is given twice"},
        {"joints: {a: b}\n", "tank.yaml:1: joints: expected a list"},
        {"joints:\n  - 3\n", "tank.yaml:2: joints: expected `- key: value`"},
        {"joints:\n  - {class: 4096, metric: azimuth}\n", "tank.yaml:2: joints: nodes: is missing"},
        {"joints:\n  - {nodes: a, hinge: 3}\n",
         "tank.yaml:2: no such key: joints.hinge; all keys: `pitviper model --keys`"},
        {"joints:\n  - {nodes: a, class: 4097, metric: azimuth}\n",
         "joints.class: '4097' is not primary_ or secondary_"},
        {"joints:\n  - {nodes: a, class: primary_turret_11, metric: azimuth}\n", "'primary_turret_11' is not"},
        {"joints:\n  - {nodes: a, class: primary_turret_1}\n", "class and metric belong together"},
        {"joints:\n  - {nodes: a, metric: tilt}\n", "'tilt' is not one of position, extension"},
        {"joints:\n  - {nodes: a, axis: 0 0 0}\n", "joints.axis: '0 0 0' is not yaw, pitch"},
        {"joints:\n  - {nodes: a, limits_deg: 5 -5}\n", "'5 -5' is not low high in -3600 .. 3600 deg"},
        {"joints:\n  - {nodes: a, limits_deg: 0 1, limits_m: 0 1}\n", "a joint turns or slides"},
        {"joints:\n  - {nodes: a, rest_deg: 361}\n", "'361' is not a number in -360 .. 360 deg"},
        {"joints:\n  - {nodes: a, spin_rpm: 3}\n", "axis: is missing: about what spin_rpm turns"},
        {"joints:\n  - {nodes: a, each: yes}\n", "'yes' is not true or false"},
        {"joints:\n  - {nodes: a, each: true, pivot: 0 0 0}\n", "one place for each of many joints"},
        {"joints:\n  - {nodes: [], axis: yaw}\n", "tank.yaml:2: joints: nodes: is missing"},
        {"joints:\n  - {nodes: a, roll_radius: 0}\n", "'0' is not auto or a number in 0.01 .. 10 m"},
        {"scale: &a [*a]\n", "tank.yaml:1: "},
        {"- a\n", "expected `key: value` lines"},
        {"scale:\t\n\t1\n", "tank.yaml:"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        Sidecar      s = {.joint_count = 77};
        const Status status = parse(&s, bad[i].text);
        if (!bad[i].said) {
            assert_int_equal(status, STATUS_OK);
            sidecar_close(&s);
            continue;
        }
        if (status == STATUS_OK) fail_msg("accepted: %s", bad[i].text);
        if (!strstr(check_said, bad[i].said))
            fail_msg("%s: said '%s' where '%s' was wanted", bad[i].text, check_said, bad[i].said);
        CHECK(s.joint_count == 77); /* untouched */
    }
}

static void a_missing_or_huge_file_is_said(void **state)
{
    (void)state;
    Sidecar s;
    log_set_sink(check_listen, NULL);
    assert_int_equal(sidecar_read(&s, "/tmp/pitviper-no-such-file.yaml"), STATUS_IO);
    CHECK(strstr(check_said, "cannot open"));
    char *text = malloc(sidecar_max_octets + 2), path[text_file_size];
    memset(text, '#', sidecar_max_octets + 1);
    text[sidecar_max_octets + 1] = 0;
    text_file(path, text);
    assert_int_equal(sidecar_read(&s, path), STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "larger than"));
    remove(path);
    free(text);
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_arrives_in_si_units),
        cmocka_unit_test(what_is_wrong_is_said),
        cmocka_unit_test(a_missing_or_huge_file_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
