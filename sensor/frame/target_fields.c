/* sensor/frame/target_fields.c: the fields of a target in truth.jsonl. */
#include "sensor/frame/json_object.h"
#include "sensor/frame/record_fields.h"
#include "sensor/frame/target_record.h"

static const void *next_band(FieldItem *item, const void *of, int i, const void *record)
{
    const TargetRecord *t = of;
    (void)record;
    if (i == BAND_COUNT) return NULL;
    snprintf(item->key, sizeof item->key, "%s", band_name((Band)i));
    return &t->band[i];
}

/* NULL: no pixel shows it. */
static const void *seen(const void *of)
{
    const TargetRecord *t = of;
    return target_box_is_empty(t->box) ? NULL : t;
}

static json_t *type_text(const void *of, const void *record)
{
    const TargetRecord *t = of;
    char                text[dis_type_text_size];
    (void)record;
    dis_entity_type_text(text, t->type);
    return json_string(text);
}

static json_t *class_name(const void *of, const void *record)
{
    const TargetRecord *t = of;
    (void)record;
    return json_string(target_class_name(t->class_number));
}

static json_t *occluder(const void *of, const void *record)
{
    char        id[dis_id_text_size];
    const char *text = target_occluder_text(id, of);
    (void)record;
    return text ? json_string(text) : NULL;
}

/* K, to a hundredth. */
static json_t *patch_temps(const void *of, const void *record)
{
    const TargetRecord *t = of;
    json_t             *patches = t->patches > 0 ? json_array() : NULL;
    (void)record;
    for (int k = 0; k < t->patches; k++)
        json_array_append_new(patches, json_real(round(100 * (double)t->patch_k[k]) / 100));
    return patches;
}

static const Field band_rows[] = {
    {"contrast_k", "number", "K, apparent", "", "in optical and radar; without a background",
     "mean of its pixels minus mean of a ring of equal area around it", FIELD_MEMBER(TargetBand, contrast_k),
     FIELD_WITHIN(0.05, 0.01)},
    {"dt_rss_k", "number", "K, apparent", "", "in optical and radar; without a background",
     "root of contrast_k squared plus the variance over the target", FIELD_MEMBER(TargetBand, dt_rss_k),
     FIELD_WITHIN(0.05, 0.01)},
    {"contrast", "number", "", "", "in mwir and lwir; without a background",
     "the same difference divided by the mean of the ring", FIELD_MEMBER(TargetBand, contrast),
     FIELD_WITHIN(0.01, 0.01)},
    {"snr", "number", "", "", "without a background (not in optical); with a contrast, but neither clutter nor noise",
     "contrast divided by the rms sum of the ring's standard deviation and the detector's noise; in optical at least 5e-5 W/(m2 sr) of it without a sensor: a dark image shows nothing. Optical, where nothing surrounds it: its mean over the noise",
     FIELD_MEMBER(TargetBand, snr), FIELD_WITHIN(0.05, 0.02)},
    {"veil_transmittance", "number", "", "0 .. 1", "in radar",
     "path transmittance of smoke and dust in front of it; 1: none", FIELD_MEMBER(TargetBand, veil_transmittance),
     FIELD_WITHIN(0.002, 0)},
    {"intensity_w_sr", "number", "W/sr", "in-band, at the aperture", "in radar", "its radiance times its area",
     FIELD_MEMBER(TargetBand, intensity_w_sr), FIELD_WITHIN(1e-4, 0.01)},
    {"intensity_error_w_sr", "number", "W/sr", "", "in radar, of a target that is not small, with quality.budget off",
     "rms sampling error of intensity_w_sr", FIELD_MEMBER(TargetBand, intensity_error_w_sr), FIELD_WITHIN(1e-4, 0.05)},
    {"error_rms_k", "number", "K, apparent", "", "in optical and radar; with quality.budget off",
     "its own error: rms over its pixels, by that displacement, heat and tables", FIELD_MEMBER(TargetBand, error_rms_k),
     FIELD_WITHIN(0.05, 0.05), .newer = true, .channel = FIELD_ERROR},
    {"error_median_k", "number", "K, apparent", "", "in optical and radar; with quality.budget off",
     "the same, median of its pixels' expected errors", FIELD_MEMBER(TargetBand, error_median_k),
     FIELD_WITHIN(0.05, 0.05), .newer = true, .channel = FIELD_ERROR},
};
static const FieldTable band_fields = FIELD_TABLE(band_rows);

static const Field bands_rows[] = {
    {"BAND", "object", "", "", "when the band was not rendered or it is occluded", "its signal in one band",
     .item = next_band, .unless_empty = true, .rows = &band_fields},
};
static const FieldTable bands_fields = FIELD_TABLE(bands_rows);

static const Field target_rows[] = {
    {"entity", "string", "", "site:application:entity", "", "its id", FIELD_MEMBER(TargetRecord, id), FIELD_EXACT},
    {"marking", "string", "", "", "", "its marking, at most 11 characters", FIELD_MEMBER(TargetRecord, marking),
     FIELD_EXACT},
    {"type", "string", "", "kind.domain.country.category.subcategory.specific.extra", "", "its entity type",
     .get = type_text, FIELD_EXACT},
    {"class", "string", "", "", "", "tank, apc, truck ...: its category in coco.json, by its entity type",
     .get = class_name},
    {"plane_value", "integer", "", "from 1; 0: none", "", "its value in plane `entity` of the truth EXR",
     FIELD_MEMBER(TargetRecord, plane_value)},
    {"model", "string", "", "", "", "its model, a row of etc/catalog.csv", FIELD_MEMBER(TargetRecord, model),
     FIELD_EXACT},
    {"range_m", "number", "m", "", "", "from the sensor to the centre of its model",
     FIELD_MEMBER(TargetRecord, range_m), FIELD_WITHIN(1e-3, 1e-6)},
    {"closing_mps", "number", "m/s", "", "", "closing speed: -d(range_m)/dt", FIELD_MEMBER(TargetRecord, closing_mps),
     FIELD_WITHIN(1e-3, 1e-6)},
    {"aspect_deg", "number", "deg", "its body; clockwise from above", "",
     "direction of the sensor from the target: 0 nose on, 90 from its right, 0 .. 360",
     FIELD_MEMBER(TargetRecord, aspect_rad), .as = field_deg, FIELD_WITHIN(1e-3, 0)},
    {"depression_deg", "number", "deg", "ENU at the sensor", "", "angle below the horizontal: -los_el_deg",
     FIELD_MEMBER(TargetRecord, depression_rad), .as = field_deg, FIELD_WITHIN(1e-4, 0)},
    {"los_az_deg", "number", "deg", "ENU at the sensor, from north over east", "", "line of sight, 0 .. 360",
     FIELD_MEMBER(TargetRecord, los_az_rad), .as = field_deg, FIELD_WITHIN(1e-4, 0)},
    {"los_el_deg", "number", "deg", "ENU at the sensor", "", "line of sight above the horizontal",
     FIELD_MEMBER(TargetRecord, los_el_rad), .as = field_deg, FIELD_WITHIN(1e-4, 0)},
    {"los_rate_dps", "list of 2 numbers", "deg/s", "camera right, camera up; inertial space", "",
     "rate of the line of sight, as used by proportional navigation", FIELD_MEMBER(TargetRecord, los_rate_rps),
     .as = field_deg, FIELD_WITHIN(1e-3, 1e-5)},
    {"boresight_error_deg", "list of 2 numbers", "deg", "camera right, camera up", "",
     "line of sight from the boresight", FIELD_MEMBER(TargetRecord, boresight_error_rad), .as = field_deg,
     FIELD_WITHIN(1e-4, 0)},
    {"pixels", "number", "px", "", "", "visible area with fractions of pixels; 0: occluded",
     FIELD_MEMBER(TargetRecord, pixels), FIELD_WITHIN(0.02, 0.005), .channel = FIELD_TARGETS},
    {"visible_fraction", "number", "", "0 .. 1", "when no sample hit it",
     "share of its projected area that is not occluded", FIELD_MEMBER(TargetRecord, visible_fraction),
     FIELD_WITHIN(0.005, 0), .channel = FIELD_TARGETS},
    {"foliage_fraction", "number", "", "0 .. 1", "with terrain.woods off; when no sample hit it",
     "share of its projected area that plants hide", FIELD_MEMBER(TargetRecord, foliage_fraction),
     FIELD_WITHIN(0.005, 0), .channel = FIELD_TARGETS},
    {"box_px", "list of 4 integers", "px", "image: left, top, right, bottom; from 0, the last two beyond it",
     "when it has no pixel of its own", "bounding box of its visible pixels", .at = seen,
     FIELD_MEMBER(TargetRecord, box), FIELD_EXACT, .channel = FIELD_TARGETS},
    {"amodal_box_px", "list of 4 numbers", "px", "image: left, top, right, bottom", "",
     "bounding box of all its vertices, occluded or not, not cropped by the image",
     FIELD_MEMBER(TargetRecord, amodal_box), FIELD_WITHIN(0.02, 0), .channel = FIELD_TARGETS},
    {"occluded_by", "string", "", "site:application:entity, `ground`, or `trees`",
     "when less than 1 % of it is occluded", "what occludes most of it", .get = occluder, FIELD_EXACT,
     .channel = FIELD_TARGETS},
    {"dt_k", "number", "K", "", "without thermal history",
     "mean temperature of its surface, by area, less that of open ground where it is", FIELD_MEMBER(TargetRecord, dt_k),
     FIELD_WITHIN(0.05, 0), .channel = FIELD_TEMP},
    {"patch_temp_k", "list of numbers", "K", "in the order of `pitviper heat MODEL`", "without thermal history",
     "temperature of each patch of its surface, also of those that are not seen", .get = patch_temps,
     FIELD_WITHIN(0.05, 0), .channel = FIELD_TEMP},
    {"age_s", "number", "s", "", "", "since its last Entity State", FIELD_MEMBER(TargetRecord, age_s),
     FIELD_WITHIN(1e-5, 0)},
    {"position_error_m", "number", "m", "", "", "error of dead reckoning when it was received",
     FIELD_MEMBER(TargetRecord, position_error_m), FIELD_WITHIN(1e-3, 1e-3)},
    {"error_px", "number", "px", "", "when it is occluded; with quality.budget off",
     "its own error of position: rms displacement on the image by dead reckoning, facets and the ground",
     FIELD_MEMBER(TargetRecord, error_px), FIELD_WITHIN(0.01, 0.05), .newer = true, .channel = FIELD_ERROR},
    {"bands", "object", "", "", "", "signal by band; empty: it is occluded", .rows = &bands_fields,
     .channel = FIELD_SIGNALS},
};
const FieldTable target_fields = FIELD_TABLE(target_rows);
