/* sensor/publish/klv/klv_vmti.c: the ST 0903 VMTI local set: targets, the algorithms that found them, their classes. */

#include "sensor/publish/klv/klv_private.h"
#include "sensor/publish/klv/klv.h"
#include "sensor/frame/target_record.h"

enum {
    most_classes = 16,
    most_algorithms = 4, /* named in one packet */
    name_most = 31,
    text_most = 63,
    series_room = 4096,
    target_room = 128,
    set_room = 256,
};

typedef struct Names {
    int         classes, algorithms;
    const char *class_name[most_classes];
    const char *algorithm[most_algorithms], *version[most_algorithms];
} Names;

static bool same_text(const char *a, const char *b) { return a && b && strcmp(a, b) == 0; }

/* Numbers of its class and algorithm, from 1; 0: none, or too many others. */
static void name_target(int *class_id, int *algorithm_id, Names *names, const KlvTarget *t)
{
    int k = 0;
    for (*class_id = 0; t->class_name && *t->class_name && k < most_classes && *class_id == 0; k++) {
        if (k == names->classes) names->class_name[names->classes++] = t->class_name;
        if (same_text(names->class_name[k], t->class_name)) *class_id = k + 1;
    }
    const char *version = t->algorithm_version ? t->algorithm_version : "";
    k = 0;
    for (*algorithm_id = 0; t->algorithm && *t->algorithm && k < most_algorithms && *algorithm_id == 0; k++) {
        if (k == names->algorithms) {
            names->algorithm[k] = t->algorithm;
            names->version[k] = version;
            names->algorithms++;
        }
        if (same_text(names->algorithm[k], t->algorithm) && same_text(names->version[k], version))
            *algorithm_id = k + 1;
    }
}

static bool has_box(const View *view, const int box[4])
{
    return box[0] >= 0 && box[1] >= 0 && box[0] < box[2] && box[1] < box[3] && box[2] <= view->width &&
           box[3] <= view->height;
}

static void put_place(KlvWriter *w, const Geodetic *place)
{
    const double lat_deg = place->lat_rad / rad_per_deg, lon_deg = place->lon_rad / rad_per_deg;
    if (!(fabs(lat_deg) <= 90 && fabs(lon_deg) <= 180 && place->h_m >= -900 && place->h_m <= 19000)) return;
    klv_put_oid(w, 17);
    klv_put_length(w, 10);
    klv_put_imapb(w, 4, -90, 90, lat_deg);
    klv_put_imapb(w, 4, -180, 180, lon_deg);
    klv_put_imapb(w, 2, -900, 19000, place->h_m);
}

/* Puts the local set of a VTarget pack after its id. */
static void put_target(KlvWriter *w, const View *view, const KlvTarget *t, int class_id, int algorithm_id)
{
    const int around[4] = {t->point[0], t->point[1], t->point[0] + 1, t->point[1] + 1};
    double    percent = 0;
    if (has_box(view, t->box)) {
        const double area_px = (double)(t->box[2] - t->box[0]) * (t->box[3] - t->box[1]);
        uint64_t     number[2];
        target_box_pixel_numbers(number, t->box, view->width);
        klv_item_short(w, 1, target_box_centre_number(t->box, view->width));
        klv_item_short(w, 2, number[0]);
        klv_item_short(w, 3, number[1]);
        if (t->pixels > 0) percent = clamp(floor(100 * t->pixels / area_px + 0.5), 1, 100);
    }
    if (t->pointed && has_box(view, around)) klv_item_short(w, 1, target_box_centre_number(around, view->width));
    if (t->confidence >= 0 && t->confidence <= 1) klv_item_number(w, 5, (uint64_t)(100 * t->confidence + 0.5), 1);
    if (percent > 0) klv_item_number(w, 7, (uint64_t)percent, 1);
    if (t->located) put_place(w, &t->place);
    if (algorithm_id > 0) klv_item_short(w, 22, (uint64_t)algorithm_id);
    if (class_id > 0) { /* a series of one VObject: of that class */
        const uint8_t object[] = {3, 3, 1, (uint8_t)class_id};
        klv_item(w, 107, object, sizeof object);
    }
}

/* Puts an element of a series after its length, as all of them are. */
static void put_element(KlvWriter *series, const KlvWriter *element)
{
    klv_put_length(series, element->used);
    klv_put(series, element->octet, element->used);
    series->full |= element->full;
}

static void put_algorithms(KlvWriter *w, const Names *names, bool truth)
{
    uint8_t   octet[series_room];
    KlvWriter series = {.octet = octet, .room = sizeof octet};
    for (int k = 0; k < names->algorithms; k++) {
        uint8_t   of[set_room];
        KlvWriter set = {.octet = of, .room = sizeof of};
        klv_item_short(&set, 1, (uint64_t)(k + 1));
        klv_item_text(&set, 2, names->algorithm[k], name_most);
        klv_item_text(&set, 3, *names->version[k] ? names->version[k] : "unknown", name_most);
        if (truth) klv_item_text(&set, 4, "truth", name_most);
        put_element(&series, &set);
    }
    if (names->algorithms > 0) klv_item(w, 102, octet, series.used);
    w->full |= series.full;
}

/* Puts a name as the last part of a URN. */
static void put_class(KlvWriter *series, int id, const char *name, const char *kind)
{
    uint8_t   of[set_room];
    char      plain[name_most + 1], urn[96];
    KlvWriter set = {.octet = of, .room = sizeof of};
    size_t    used = 0;
    for (; *name && used < name_most; name++) {
        const bool letter = (*name >= 'a' && *name <= 'z') || (*name >= 'A' && *name <= 'Z');
        plain[used++] = letter || (*name >= '0' && *name <= '9') || *name == '.' || *name == '_' ? *name : '-';
    }
    plain[used] = 0;
    klv_item_short(&set, 1, (uint64_t)id);
    snprintf(urn, sizeof urn, "urn:pitviper:%s", kind);
    klv_item_text(&set, 3, urn, sizeof urn - 1);
    snprintf(urn, sizeof urn, "urn:pitviper:%s:%s", kind, plain);
    klv_item_text(&set, 4, urn, sizeof urn - 1);
    klv_item_text(&set, 6, plain, name_most);
    put_element(series, &set);
}

static void put_classes(KlvWriter *w, const Names *names, bool truth)
{
    uint8_t   octet[series_room];
    KlvWriter series = {.octet = octet, .room = sizeof octet};
    for (int k = 0; k < names->classes; k++)
        put_class(&series, k + 1, names->class_name[k], truth ? "truth" : "detected");
    if (names->classes > 0) klv_item(w, 103, octet, series.used);
    w->full |= series.full;
}

/* Puts the series of VTarget packs, and returns how many there are. An id occurs once: of two targets with the same id,
 * the first is kept. */
static int put_targets(KlvWriter *series, Names *names, const View *view, const KlvTargets *targets)
{
    uint64_t id[klv_most_targets];
    int      count = 0;
    for (int k = 0; k < targets->count && count < klv_most_targets; k++) {
        uint8_t   of[target_room];
        KlvWriter pack = {.octet = of, .room = sizeof of};
        int       class_id, algorithm_id;
        bool      again = false;
        for (int i = 0; i < count; i++) again |= id[i] == targets->target[k].id;
        if (again) continue;
        name_target(&class_id, &algorithm_id, names, &targets->target[k]);
        klv_put_oid(&pack, targets->target[k].id);
        const size_t without = pack.used;
        put_target(&pack, view, &targets->target[k], class_id, algorithm_id);
        if (pack.used == without) continue; /* nothing is known of it */
        id[count++] = targets->target[k].id;
        put_element(series, &pack);
    }
    return count;
}

void klv_vmti(KlvWriter *w, const FrameRecord *record, uint64_t time_us, const KlvSource *source,
              const KlvTargets *targets)
{
    static const uint64_t most = 0xFFFFFF; /* of counts and sizes: three octets */
    const View           *view = &record->request->view;
    const int             number = targets->elsewhen ? targets->frame : record->frame;
    const int             total = targets->total > targets->count ? targets->total : targets->count;
    uint8_t               octet[klv_most_targets * target_room];
    KlvWriter             series = {.octet = octet, .room = sizeof octet};
    Names                 names = {0};
    const int             count = put_targets(&series, &names, view, targets);

    if (targets->elsewhen) klv_time_us(&time_us, targets->unix_s);
    klv_item_number(w, 2, time_us, 8);
    klv_item_text(w, 3, targets->truth ? "Pitviper truth" : "Pitviper ATR", name_most);
    klv_item_short(w, 4, klv_vmti_version);
    klv_item_short(w, 5, (uint64_t)total < most ? (uint64_t)total : most);
    klv_item_short(w, 6, (uint64_t)count);
    if (number >= 0) klv_item_short(w, 7, (uint64_t)number & most);
    klv_item_short(w, 8, (uint64_t)view->width & most);
    klv_item_short(w, 9, (uint64_t)view->height & most);
    klv_item_text(w, 10, klv_sensor_name(source), text_most);
    klv_item_imapb(w, 11, 2, 0, 180, record->hfov_rad / rad_per_deg);
    klv_item_imapb(w, 12, 2, 0, 180, klv_vfov_deg(record));
    if (count > 0) klv_item(w, 101, octet, series.used);
    put_algorithms(w, &names, targets->truth);
    put_classes(w, &names, targets->truth);
    w->full |= series.full;
}

/* ---- the targets of a frame's truth as targets of the metadata, marked as truth ------------------ */

static KlvTarget truth_target(const TargetRecord *t)
{
    const DisEntityId id = t->id;
    KlvTarget         out = {.id = (uint64_t)id.site << 32 | (uint64_t)id.application << 16 | id.entity,
                             .confidence = NAN,
                             .pixels = t->pixels,
                             .algorithm = "truth",
                             .algorithm_version = PITVIPER_VERSION,
                             .class_name = target_class_name(t->class_number)};
    memcpy(out.box, t->box, sizeof out.box);
    out.located = geodetic_from_ecef(&out.place, t->p_ecef) == STATUS_OK;
    return out;
}

void klv_truth_targets(KlvTargets *out, KlvTarget kept[klv_most_targets], const FrameRecord *r)
{
    const TargetRecord *largest[klv_most_targets];
    *out = (KlvTargets){.truth = true, .target = kept};
    for (int i = 0; i < r->target_count; i++) {
        const TargetRecord *t = &r->target[i];
        if (!(t->pixels > 0) || target_box_is_empty(t->box)) continue;
        out->total++;
        int at = out->count; /* behind all that are as large */
        while (at > 0 && largest[at - 1]->pixels < t->pixels) at--;
        if (at == klv_most_targets) continue;
        const int moved = (out->count < klv_most_targets ? out->count : klv_most_targets - 1) - at;
        memmove(&largest[at + 1], &largest[at], (size_t)moved * sizeof *largest);
        largest[at] = t;
        if (out->count < klv_most_targets) out->count++;
    }
    for (int k = 0; k < out->count; k++) kept[k] = truth_target(largest[k]);
}
