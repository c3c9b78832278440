/* tests/fuzz/fuzz_sidecar.c: any octets as a model's sidecar. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "entities/import/sidecar.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

/* Every key once, in one of two spellings. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const seed[2] = {
        "file: a.glb\nname: T\nscale: 0.01\naxes: +z +y\norigin: 0 1 2\ncrease_deg: 40\ndrop: [crew/*, air]\n"
        "joints:\n"
        "  - {name: turret, nodes: [t, u*], class: primary_turret_1, metric: azimuth, pivot: 0 0 1}\n"
        "  - {name: gun, nodes: g, parent: turret, class: 4416, metric: elevation, limits_deg: -5 18, rest_deg: 15}\n"
        "  - {nodes: \"w*\", each: true, pivot: centre, roll_radius: auto, axis: left}\n"
        "  - {nodes: rotor, axis: 0 1 0, spin_rpm: 300}\n"
        "  - {nodes: mast, axis: up, class: 2048, metric: extension, limits_m: 0 2}\n"
        "materials: {a: paint_olive, \"*\": paint_sand}\nnode_materials: {w*: rubber_black}\n"
        "roles: {w*: wheel}\nthickness_mm: {w*: 30, \"*\": 0.5}\ndamage: {destroyed: {hide: [a, b], materials: {\"*\": metal_dark}}}\n",
        "axes: -x +z\norigin: auto\njoints:\n- nodes: &n\n  - a\n  - b\n  axis: [0, 0, 1]\n- nodes: *n\n  axis: -y\n"
        "damage:\n  slight:\n    hide: x\n",
    };
    return fuzz_seed_text(out, seed[index % 2]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    log_set_level((LogLevel)(LOG_ERROR + 1));
    Sidecar s;
    if (sidecar_parse(&s, "fuzz.yaml", (const char *)data, size) != STATUS_OK) return 0;
    /* what the importer builds on */
    if (s.scale_m != 0 && !(s.scale_m >= 1e-6 && s.scale_m <= 1e6)) abort();
    if (s.has_axes && !(v3_dot(s.forward, s.up) == 0 && v3_length(s.forward) == 1 && v3_length(s.up) == 1)) abort();
    if (!(s.crease_rad >= 0 && s.crease_rad <= pi_rad) || !v3_is_finite(s.p_origin_file)) abort();
    for (int j = 0; j < s.joint_count; j++) {
        const SidecarJoint *joint = &s.joint[j];
        if (joint->pattern_count < 1 || joint->pattern_count > sidecar_max_patterns) abort();
        if (!v3_is_finite(joint->p_pivot_file) || !isfinite(joint->rest) || !isfinite(joint->spin_rps)) abort();
        if (joint->axis != AXIS_DEFAULT && !(fabs(v3_length(joint->axis_xyz) - 1) <= 1e-9)) abort();
        if (joint->has_limits && !(joint->low <= joint->high)) abort();
        if (joint->slides && !joint->has_limits) abort();
    }
    for (int i = 0; i < s.thickness.count; i++) {
        double mm;
        if (!text_to_double(&mm, s.thickness.rule[i].value) || !(mm >= 0.1 && mm <= 1000)) abort();
    }
    sidecar_close(&s);
    return 0;
}
