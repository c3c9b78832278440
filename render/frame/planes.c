/* render/frame/planes.c: the list of planes, and what follows from it alone: making them, and finding one. */
#include "render/frame/planes.h"

#define BANDS(band) (1u << BAND_##band)
#define AT(member)  offsetof(Picture, member)

/* Emissivity of the surface at each pixel's centre in a thermal band, 0 .. 1: 1 - reflectance - transmittance of its
 * row of etc/materials.csv or etc/plant_optics.csv, hemispherical; NaN: sky. */
static void make_emissivity(float *out, const PlaneRow *plane, const Picture *picture, const Materials *materials)
{
    const size_t    count = (size_t)picture->width * (size_t)picture->height;
    const Material *row = materials->material;
    const bool      mwir = plane->bands == BANDS(MWIR);
    uint32_t        last = 0;
    float           value = NAN;
    for (size_t i = 0; i < count; i++) {
        const uint32_t material = picture->material[i];
        if (material != last) { /* neighbours are mostly of one material */
            const Material *m = material < (uint32_t)materials->count ? &row[material] : NULL;
            value = !m || material == 0 ? NAN : mwir ? 1 - m->rho_mwir - m->tau_mwir : 1 - m->rho_lwir - m->tau_lwir;
            last = material;
        }
        out[i] = value;
    }
}

static const char radiance[] = "radiance at the aperture", per_sr[] = "W/(m2 sr)", same[] = "the same";
static const char not_rgb[] = "with sensor.optical pan or nir", bare[] = "with terrain.woods off";

/* clang-format off */
#define LIGHT(group, name, frame, absent, band, member, mantissa, three) \
    {group, name, PLANE_RADIANCE, PLANE_F32, per_sr, frame, absent, radiance, BANDS(band), .at = AT(member), \
     .record = group "." name, .verdict = group, .rounding = {.bits = mantissa}, .rgb = three}
#define NORMAL(name, k, frame, about) \
    {"truth", name, PLANE_TRUTH, PLANE_F32, "", "ENU at the terrain origin, " frame, "", about, \
     .at = AT(normal[k]), .choice = "normal", .record = name, .verdict = "normal", .rounding = {.step = 1.0 / 512}}

const PlaneRow plane_rows[] = {
    LIGHT("optical", "R", "0.6-0.7 um", not_rgb, OPTICAL, optical[0], 7, true),
    LIGHT("optical", "G", "0.5-0.6 um", not_rgb, OPTICAL, optical[1], 7, true),
    LIGHT("optical", "B", "0.4-0.5 um", not_rgb, OPTICAL, optical[2], 7, true),
    LIGHT("optical", "Y", "pan 0.4-0.7 um, nir 0.7-1.1 um", "with sensor.optical rgb", OPTICAL, optical[0], 7, false),
    LIGHT("mwir", "Y", "3.4-4.8 um", "", MWIR, mwir, 10, false),
    LIGHT("lwir", "Y", "8-12 um", "", LWIR, lwir, 11, false),
    {"radar", "Y", PLANE_RADIANCE, PLANE_F32, "relative", "", "",
     "power of the pseudo-radar: comparable within a run, in no physical unit",
     .bands = BANDS(RADAR), .at = AT(radar), .record = "radar.Y", .verdict = "radar", .rounding = {.bits = 7}},
    {"truth", "range_m", PLANE_TRUTH, PLANE_F32, "m", "from the sensor, along the ray", "",
     "range of the surface at the pixel's centre; +infinity: sky",
     .at = AT(range_m), .choice = "range", .record = "range_m", .verdict = "range", .rounding = {.bits = 16}},
    {"truth", "entity", PLANE_TRUTH, PLANE_U32, "", "from 1, into entity_ids; 0: none", "", "entity",
     .at = AT(entity), .choice = "entity", .record = "entity", .verdict = "entity"},
    {"truth", "part", PLANE_TRUTH, PLANE_U32, "", "from 1, into the parts of its model in part_names; 0: none", "", "part of its model",
     .at = AT(part), .choice = "part", .record = "part", .verdict = "part"},
    {"truth", "material", PLANE_TRUTH, PLANE_U32, "", "from 1, into material_names; 0: none", "", "material",
     .at = AT(material), .choice = "material", .record = "material", .verdict = "material"},
    {"truth", "instance", PLANE_TRUTH, PLANE_U32, "", "from 1; from 2147483648 low plants; 0: none", bare,
     "plant: each one has its own number; low plants, which stand only near the sensor, theirs in this frame; where there is a part and no entity, scenery: its object",
     .plants = PLANTS_MAKE, .at = AT(instance), .choice = "instance"},
    {"truth", "cover", PLANE_TRUTH, PLANE_U8, "", "from 1, into surface_names; 0: no ground", bare, "surface class of the ground",
     .plants = PLANTS_LIST, .at = AT(cover), .choice = "cover"},
    {"truth", "temp_k", PLANE_TRUTH, PLANE_F32, "K", "", "", "temperature of the surface; NaN: sky",
     .at = AT(temp_k), .choice = "temperature", .record = "temp_k", .verdict = "temperature", .rounding = {.step = 1.0 / 32}},
    {"truth", "emissivity_mwir", PLANE_TRUTH, PLANE_F32, "", "0 .. 1", "without mwir",
     "1 - reflectance - transmittance of the material, hemispherical: its row of etc/materials.csv, of plants etc/plant_optics.csv; NaN: sky",
     .bands = BANDS(MWIR), .make = make_emissivity, .choice = "emissivity"},
    {"truth", "emissivity_lwir", PLANE_TRUTH, PLANE_F32, "", "0 .. 1", "without lwir", same,
     .bands = BANDS(LWIR), .make = make_emissivity, .choice = "emissivity"},
    NORMAL("nx", 0, "east", "unit normal of the surface"),
    NORMAL("ny", 1, "north", same),
    NORMAL("nz", 2, "up", same),
    {"radar", "profile", PLANE_PROFILE, PLANE_F64, "relative", .bands = BANDS(RADAR), .at = AT(profile)},
};
/* clang-format on */
const int plane_row_count = sizeof plane_rows / sizeof *plane_rows;
_Static_assert(sizeof plane_rows / sizeof *plane_rows <= planes_most, "planes_most is too small");

/* ---- one of them ----------------------------------------------------------------------------------- */

int plane_find(const char *group, const char *name)
{
    int k = plane_row_count - 1;
    while (k >= 0 && (strcmp(plane_rows[k].name, name) != 0 || strcmp(plane_rows[k].group, group) != 0)) k--;
    return k;
}

const PlaneRow *plane_recorded(int i)
{
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < plane_row_count; k++)
            if (plane_rows[k].record && (plane_rows[k].kind == PLANE_TRUTH) == (pass == 0) && i-- == 0)
                return &plane_rows[k];
    return NULL;
}

PlaneSet planes_named(const char *choice, size_t length)
{
    PlaneSet set = 0;
    for (int k = 0; k < plane_row_count; k++) {
        const char *name = plane_rows[k].choice;
        if (name && (length == 0 || (strlen(name) == length && memcmp(name, choice, length) == 0)))
            set |= (PlaneSet)1 << k;
    }
    return set;
}

Band plane_band(const PlaneRow *row)
{
    Band band = BAND_OPTICAL;
    while (band < BAND_COUNT && !has_band(row->bands, band)) band++;
    return band;
}

const char *plane_group(const PlaneRow *row)
{
    return row->kind == PLANE_TRUTH ? row->group : band_name(plane_band(row));
}

bool plane_of_bands(const PlaneRow *row, unsigned bands, OpticalChannels optical)
{
    if (row->bands && !(row->bands & bands)) return false;
    return row->kind != PLANE_RADIANCE || row->bands != BANDS(OPTICAL) || row->rgb == (optical == OPTICAL_RGB);
}

const void *plane_values(const PlaneRow *row, const Picture *picture)
{
    const void *values;
    if (row->make || (row->plants != PLANTS_OR_NOT && !picture->instance)) return NULL;
    memcpy(&values, (const char *)picture + row->at, sizeof values);
    return values;
}

/* ---- made ------------------------------------------------------------------------------------------ */

static void put_values(Picture *picture, const PlaneRow *row, void *values)
{
    memcpy((char *)picture + row->at, &values, sizeof values);
}

Status planes_create(Picture *picture, const RenderRequest *request, int entities, bool instances, Arena *arena)
{
    static const size_t octets[] = {
        [PLANE_F32] = sizeof(float), [PLANE_U32] = sizeof(uint32_t), [PLANE_F64] = sizeof(double), [PLANE_U8] = 1};
    const size_t px = (size_t)request->view.width * (size_t)request->view.height;
    const size_t bins = request->profile_bins > 0 ? (size_t)request->profile_bins : 0;
    /* edges are where truth changes; pixels without rays are filled by what those beside them show */
    const bool truth = request->truth || looks_for_edges(request) || request->sampling > SAMPLING_TARGETS;
    bool       ok = true;
    *picture = (Picture){.width = request->view.width, .height = request->view.height};
    for (int k = 0; k < plane_row_count; k++) {
        const PlaneRow *row = &plane_rows[k];
        const size_t    count = row->kind == PLANE_PROFILE ? bins * radar_bounces : px;
        if (row->make || !plane_of_bands(row, request->bands, request->optical) ||
            (row->kind == PLANE_TRUTH && !truth) || (row->plants == PLANTS_MAKE && !instances) || count == 0)
            continue;
        /* a profile is summed into; every pixel of the other planes is written before it is read */
        void *values = row->kind == PLANE_PROFILE ? arena_alloc(arena, count, octets[row->type])
                                                  : arena_alloc_raw(arena, count, octets[row->type]);
        put_values(picture, row, values);
        ok &= values != NULL;
    }
    if (request->truth) ok = (picture->target = arena_alloc(arena, (size_t)entities, sizeof(TargetPixels))) && ok;
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}

void planes_forget_truth(Picture *picture)
{
    for (int k = 0; k < plane_row_count; k++)
        if (plane_rows[k].kind == PLANE_TRUTH && !plane_rows[k].make) put_values(picture, &plane_rows[k], NULL);
}
