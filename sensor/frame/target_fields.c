/* sensor/frame/target_fields.c: the fields of a target in truth.jsonl. */
#include "sensor/frame/json_object.h"
#include "sensor/frame/record_fields.h"
#include "sensor/frame/target_record.h"

static const void *next_band(FieldAt *at, int i)
{
    const TargetRecord *t = at->of;
    return i < BAND_COUNT ? field_keyed(at, band_name((Band)i), &t->band[i]) : NULL;
}

/* NULL: no pixel shows it. */
static const void *seen(const void *of) { return target_box_is_empty(((const TargetRecord *)of)->box) ? NULL : of; }

static json_t *type_text(FieldAt *at)
{
    char text[dis_type_text_size];
    dis_entity_type_text(text, ((const TargetRecord *)at->of)->type);
    return json_string(text);
}

static json_t *class_name(FieldAt *at)
{
    return json_string(target_class_name(((const TargetRecord *)at->of)->class_number));
}

static json_t *occluder(FieldAt *at)
{
    char        id[dis_id_text_size];
    const char *text = target_occluder_text(id, at->of);
    return text ? json_string(text) : NULL;
}

/* K, to a hundredth. */
static json_t *patch_temps(FieldAt *at)
{
    const TargetRecord *t = at->of;
    json_t             *patches = t->patches > 0 ? json_array() : NULL;
    for (int k = 0; k < t->patches; k++)
        json_array_append_new(patches, json_real(round(100 * (double)t->patch_k[k]) / 100));
    return patches;
}

#define OF_TARGET(member) FIELD_MEMBER(TargetRecord, member)
#define OF_BAND(member)   FIELD_MEMBER(TargetBand, member)

static const Field band_rows[] = {
    {"contrast_k", "K, apparent", "", "in optical and radar; without a background",
     "mean of its pixels minus mean of a ring of equal area around it", OF_BAND(contrast_k), FIELD_WITHIN(0.05, 0.01)},
    {"dt_rss_k", "K, apparent", "", "in optical and radar; without a background",
     "root of contrast_k squared plus the variance over the target", OF_BAND(dt_rss_k), FIELD_WITHIN(0.05, 0.01)},
    {"contrast", "", "", "in mwir and lwir; without a background",
     "the same difference divided by the mean of the ring", OF_BAND(contrast), FIELD_WITHIN(0.01, 0.01)},
    {"snr", "", "", "without a background (not in optical); with a contrast, but neither clutter nor noise",
     "contrast divided by the rms sum of the ring's standard deviation and the detector's noise; in optical at least 5e-5 W/(m2 sr) of it without a sensor: a dark image shows nothing. Optical, where nothing surrounds it: its mean over the noise",
     OF_BAND(snr), FIELD_WITHIN(0.05, 0.02)},
    {"veil_transmittance", "", "0 .. 1", "in radar", "path transmittance of smoke and dust in front of it; 1: none",
     OF_BAND(veil_transmittance), FIELD_WITHIN(0.002, 0)},
    {"intensity_w_sr", "W/sr", "in-band, at the aperture", "in radar", "its radiance times its area",
     OF_BAND(intensity_w_sr), FIELD_WITHIN(1e-4, 0.01)},
    {"intensity_error_w_sr", "W/sr", "", "in radar, of a target that is not small, with quality.budget off",
     "rms sampling error of intensity_w_sr", OF_BAND(intensity_error_w_sr), FIELD_WITHIN(1e-4, 0.05)},
    {"cycles", "", "", "in radar; without a sensor, or a background",
     "cycles across its visible part that an observer of the sensor resolves at its contrast (Johnson)",
     OF_BAND(cycles), FIELD_WITHIN(0.01, 0.02), .newer = true},
    {"ttp_v", "", "", "in radar; without a sensor, or a background",
     "its TTP value: what all frequencies add to an observer's seeing it", OF_BAND(ttp_v), FIELD_WITHIN(0.01, 0.02),
     .newer = true},
    {"p_detect", "", "0 .. 1", "in radar; without a sensor, or a background",
     "probability, by ttp_v, that the observer detects it", OF_BAND(p[TASK_DETECT]), FIELD_WITHIN(0.01, 0),
     .newer = true},
    {"p_recognise", "", "0 .. 1", "in radar; without a sensor, or a background",
     "the same, that its class is recognised", OF_BAND(p[TASK_RECOGNISE]), FIELD_WITHIN(0.01, 0), .newer = true},
    {"p_identify", "", "0 .. 1", "in radar; without a sensor, or a background", "the same, that its type is identified",
     OF_BAND(p[TASK_IDENTIFY]), FIELD_WITHIN(0.01, 0), .newer = true},
    {"error_rms_k", "K, apparent", "", "in optical and radar; with quality.budget off",
     "its own error: rms over its pixels, by that displacement, heat and tables", OF_BAND(error_rms_k),
     FIELD_WITHIN(0.05, 0.05), .newer = true, .channel = FIELD_ERROR},
    {"error_median_k", "K, apparent", "", "in optical and radar; with quality.budget off",
     "the same, median of its pixels' expected errors", OF_BAND(error_median_k), FIELD_WITHIN(0.05, 0.05),
     .newer = true, .channel = FIELD_ERROR},
};

static const Field bands_rows[] = {
    {"BAND", "", "", "when the band was not rendered or it is occluded", "its signal in one band", .item = next_band,
     .unless_empty = true, FIELD_OBJECT(band_rows)},
};

static const Field target_rows[] = {
    {"entity", "", "site:application:entity", "", "its id", OF_TARGET(id), FIELD_EXACT},
    {"marking", "", "", "", "its marking, at most 11 characters", OF_TARGET(marking), FIELD_EXACT},
    {"type", "", "kind.domain.country.category.subcategory.specific.extra", "", "its entity type",
     FIELD_GET("string", type_text), FIELD_EXACT},
    {"class", "", "", "", "tank, apc, truck ...: its category in coco.json, by its entity type",
     FIELD_GET("string", class_name)},
    {"plane_value", "", "from 1; 0: none", "", "its value in plane `entity` of the truth EXR", OF_TARGET(plane_value)},
    {"model", "", "", "", "its model, a row of etc/catalog.csv", OF_TARGET(model), FIELD_EXACT},
    {"range_m", "m", "", "", "from the sensor to the centre of its model", OF_TARGET(range_m),
     FIELD_WITHIN(1e-3, 1e-6)},
    {"closing_mps", "m/s", "", "", "closing speed: -d(range_m)/dt", OF_TARGET(closing_mps), FIELD_WITHIN(1e-3, 1e-6)},
    {"aspect_deg", "deg", "its body; clockwise from above", "",
     "direction of the sensor from the target: 0 nose on, 90 from its right, 0 .. 360", OF_TARGET(aspect_rad),
     .as = field_deg, FIELD_WITHIN(1e-3, 0)},
    {"depression_deg", "deg", "ENU at the sensor", "", "angle below the horizontal: -los_el_deg",
     OF_TARGET(depression_rad), .as = field_deg, FIELD_WITHIN(1e-4, 0)},
    {"los_az_deg", "deg", "ENU at the sensor, from north over east", "", "line of sight, 0 .. 360",
     OF_TARGET(los_az_rad), .as = field_deg, FIELD_WITHIN(1e-4, 0)},
    {"los_el_deg", "deg", "ENU at the sensor", "", "line of sight above the horizontal", OF_TARGET(los_el_rad),
     .as = field_deg, FIELD_WITHIN(1e-4, 0)},
    {"los_rate_dps", "deg/s", "camera right, camera up; inertial space", "",
     "rate of the line of sight, as used by proportional navigation", OF_TARGET(los_rate_rps), .as = field_deg,
     FIELD_WITHIN(1e-3, 1e-5)},
    {"boresight_error_deg", "deg", "camera right, camera up", "", "line of sight from the boresight",
     OF_TARGET(boresight_error_rad), .as = field_deg, FIELD_WITHIN(1e-4, 0)},
    {"pixels", "px", "", "", "visible area with fractions of pixels; 0: occluded", OF_TARGET(pixels),
     FIELD_WITHIN(0.02, 0.005), .channel = FIELD_TARGETS},
    {"visible_fraction", "", "0 .. 1", "when no sample hit it", "share of its projected area that is not occluded",
     OF_TARGET(visible_fraction), FIELD_WITHIN(0.005, 0), .channel = FIELD_TARGETS},
    {"foliage_fraction", "", "0 .. 1", "with terrain.woods off; when no sample hit it",
     "share of its projected area that plants hide", OF_TARGET(foliage_fraction), FIELD_WITHIN(0.005, 0),
     .channel = FIELD_TARGETS},
    {"box_px", "px", "image: left, top, right, bottom; from 0, the last two beyond it",
     "when it has no pixel of its own", "bounding box of its visible pixels", FIELD_IN(seen, TargetRecord, box),
     FIELD_EXACT, .channel = FIELD_TARGETS},
    {"amodal_box_px", "px", "image: left, top, right, bottom", "",
     "bounding box of all its vertices, occluded or not, not cropped by the image", OF_TARGET(amodal_box),
     FIELD_WITHIN(0.02, 0), .channel = FIELD_TARGETS},
    {"occluded_by", "", "site:application:entity, `ground`, `trees`, or `scenery`",
     "when less than 1 % of it is occluded", "what occludes most of it", FIELD_GET("string", occluder), FIELD_EXACT,
     .channel = FIELD_TARGETS},
    {"dt_k", "K", "", "without thermal history",
     "mean temperature of its surface, by area, less that of open ground where it is", OF_TARGET(dt_k),
     FIELD_WITHIN(0.05, 0), .channel = FIELD_TEMP},
    {"patch_temp_k", "K", "in the order of `pitviper heat MODEL`", "without thermal history",
     "temperature of each patch of its surface, also of those that are not seen",
     FIELD_GET("list of numbers", patch_temps), FIELD_WITHIN(0.05, 0), .channel = FIELD_TEMP},
    {"age_s", "s", "", "", "since its last Entity State", OF_TARGET(age_s), FIELD_WITHIN(1e-5, 0)},
    {"position_error_m", "m", "", "", "error of dead reckoning when it was received", OF_TARGET(position_error_m),
     FIELD_WITHIN(1e-3, 1e-3)},
    {"error_px", "px", "", "when it is occluded; with quality.budget off",
     "its own error of position: rms displacement on the image by dead reckoning, facets and the ground",
     OF_TARGET(error_px), FIELD_WITHIN(0.01, 0.05), .newer = true, .channel = FIELD_ERROR},
    {"bands", "", "", "", "signal by band; empty: it is occluded", FIELD_OBJECT(bands_rows), .channel = FIELD_SIGNALS},
};
const FieldTable target_fields = {target_rows, sizeof target_rows / sizeof *target_rows};
