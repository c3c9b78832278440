/* tests/fuzz/fuzz_truth_line.c: any octets as a line of truth.jsonl that answers are scored against; and what is picked
 * of a JSON text. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/frame/json_object.h"
#include "sensor/score/json_pick.h"
#include "sensor/score/truth_line.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

static const char seed[] =
    "{\"frame\":3,\"time_s\":1364.5,\"host\":{\"lat_deg\":10.5,\"lon_deg\":-3,\"height_m\":200,\"x\":[1,{}]},"
    "\"sun\":{\"azimuth_deg\":200,\"elevation_deg\":30},\"sensors\":[{\"bands\":[\"lwir\"],\"width_px\":64,"
    "\"height_px\":48,\"hfov_deg\":4,\"vfov_deg\":3,\"distortion\":[-0.1,0,0,0,0],\"ecef_from_cam\":[1,0,0,0,1,0,0,0,1],"
    "\"ground_km2\":1.5}],\"error\":{\"lwir\":{\"total\":0.1}},\"targets\":[{\"entity\":\"1:3001:12\",\"class\":\"tank\","
    "\"range_m\":1916.1,\"pixels\":12.5,\"aspect_deg\":3,\"box_px\":[4,3,6,5],\"amodal_box_px\":[3.5,3,6.5,5],"
    "\"bands\":{\"lwir\":{\"contrast_k\":-4.0,\"snr\":-3}}}],"
    "\"clutter\":[{\"class\":\"fire\",\"id\":\"0a\",\"pixels\":0.5,\"box_px\":[1,2,2,3],\"range_m\":90.5}]}";

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    (void)index;
    return fuzz_seed_text(out, seed);
}

/* What is left of a value when objects have the named members alone. */
static void strip(json_t *value, const char *const *names, int count)
{
    const char *key;
    json_t     *member;
    void       *next;
    size_t      i;
    if (json_is_object(value)) {
        json_object_foreach_safe(value, next, key, member)
        {
            bool wanted = false;
            for (int k = 0; k < count; k++) wanted |= strcmp(key, names[k]) == 0;
            if (wanted) strip(member, names, count);
            else json_object_del(value, key);
        }
    }
    json_array_foreach(value, i, member) strip(member, names, count);
}

/* A text that is JSON is JSON when picked from, and the same but for what was not wanted. */
static void pick(const char *text, size_t size)
{
    static const char *const names[] = {"frame", "targets", "lwir", "bands", "box_px"};
    char                    *out = malloc(size + 1);
    json_t                  *whole = json_loadb(text, size, 0, NULL);
    if (!out) abort();
    const size_t length = json_pick(out, text, size, names, 5);
    if (length > size) abort();
    json_t *picked = length > 0 ? json_loadb(out, length, 0, NULL) : NULL;
    if (whole && !memchr(text, '\\', size)) { /* keys are compared as they are written */
        strip(whole, names, 5);
        if (picked && !json_equal(whole, picked)) abort();
        if (!picked && length > 0) abort();
    }
    json_decref(whole);
    json_decref(picked);
    free(out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static TruthFrame frame; /* its list is kept from one to the next, as in use */
    JsonStream        line = {.path = "fuzz", .line = 1, .text = (char *)(uintptr_t)data, .length = size};
    log_set_level((LogLevel)(LOG_ERROR + 1));
    if (size == 0) return 0;
    pick((const char *)data, size);
    if (truth_line_read(&frame, &line) != STATUS_OK) return 0;
    if (frame.frame < 0 || frame.width < 1 || frame.height < 1 || !frame.bands || frame.count > frame.room) abort();
    if (!(frame.focal_px > 0 && frame.deg2 > 0)) abort();
    for (int i = 0; i < frame.count; i++) {
        const TruthTarget *t = &frame.target[i];
        if (t->class_number < 1 || !(t->range_m >= 0 && t->pixels >= 0 && t->amodal[2] >= 0 && t->amodal[3] >= 0))
            abort();
    }
    if (frame.clutter_count > frame.clutter_room) abort();
    for (int i = 0; i < frame.clutter_count; i++) {
        const TruthClutter *c = &frame.clutter[i];
        if (c->class_number < 0 || c->class_number >= CLUTTER_CLASSES || !(c->box[2] >= 0 && c->box[3] >= 0)) abort();
    }
    double point[2];
    if (truth_frame_point(point, &frame, 10, -1) && !(isfinite(point[0]) && isfinite(point[1]))) abort();
    return 0;
}
