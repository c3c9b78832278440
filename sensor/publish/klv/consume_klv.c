/* sensor/publish/klv/consume_klv.c: packets of metadata with the targets that publish.vmti asks for, and the consumer
 * that writes them into files, one a band. */
#include "sensor/publish/klv/consume_klv.h"
#include "pitviper_output.h"
#include "sensor/publish/files/frame_files.h"

#include <errno.h>
#include <stdlib.h>

/* ---- targets of the metadata, from answers or truth ---------------------------------------------- */

static int whole(double value, double (*to)(double)) { return (int)to(clamp(value, -1, 1e6)); }

void klv_of_answer(KlvTargets *out, KlvTarget kept[klv_most_targets], const Answer *answer)
{
    _Static_assert((int)answer_detections_most <= (int)klv_most_targets, "all of an answer are in one packet");
    *out = (KlvTargets){
        .count = answer->count, .target = kept, .elsewhen = true, .frame = answer->frame, .unix_s = answer->unix_s};
    for (int k = 0; k < answer->count; k++) {
        const AnswerDetection *d = &answer->detection[k];
        KlvTarget             *t = &kept[k];
        *t = (KlvTarget){.id = d->track ? d->track : ((uint64_t)1 << 32) + (uint64_t)k,
                         .confidence = d->score,
                         .pixels = NAN,
                         .located = d->located,
                         .place = d->place,
                         .class_name = d->class_name};
        if (!isnan(d->box_px[0])) {
            for (int side = 0; side < 4; side++) t->box[side] = whole(d->box_px[side], side < 2 ? floor : ceil);
        } else if (!isnan(d->point_px[0])) {
            t->pointed = true;
            for (int axis = 0; axis < 2; axis++) t->point[axis] = whole(d->point_px[axis], floor);
        }
    }
}

/* The targets of a frame; NULL: none are known. Valid until the next call. */
static const KlvTargets *answered(KlvAnswers *k, const Frame *frame, Band band)
{
    if (!k->from || !answers_latest(k->from, band, &k->newest)) return NULL;
    if (!(fabs(frame->unix_s - k->newest.unix_s) <= klv_answers_s)) return NULL;
    klv_of_answer(&k->targets, k->kept, &k->newest);
    return &k->targets;
}

size_t klv_of_band(uint8_t out[klv_most_octets], KlvAnswers *k, enum VmtiSource vmti, const Frame *frame, Band band,
                   const Geoid *geoid)
{
    const KlvSource   source = {.band = band, .geoid = geoid};
    const KlvTargets *targets = NULL;
    if (vmti == VMTI_TRUTH) {
        klv_truth_targets(&k->targets, k->kept, &frame->record);
        targets = &k->targets;
    } else if (vmti == VMTI_ATR) {
        targets = answered(k, frame, band);
    }
    return klv_frame(out, &frame->record, frame->unix_s, &source, targets);
}

/* ---- the consumer -------------------------------------------------------------------------------- */

typedef struct KlvConsumer {
    Consumer     consumer;
    FILE        *file[BAND_COUNT];
    KlvFiles     of;
    KlvAnswers   found;
    RetryBackoff patience;
} KlvConsumer;

static Status write_packet(FILE *file, const uint8_t *octets, size_t count)
{
    if (fwrite(octets, 1, count, file) == count && fflush(file) == 0) return STATUS_OK;
    log_error("klv: cannot write metadata: %s", strerror(errno));
    return STATUS_IO;
}

static Status put_band(KlvConsumer *k, Band band, const Frame *frame)
{
    uint8_t      octets[klv_most_octets];
    const size_t count = klv_of_band(octets, &k->found, k->of.config->publish.vmti, frame, band, k->of.geoid);
    return count > 0 ? write_packet(k->file[band], octets, count) : STATUS_OK;
}

static Status put(Consumer *consumer, Frame *frame)
{
    KlvConsumer *k = (KlvConsumer *)consumer;
    Status       status = STATUS_OK;
    const bool   due = !k->of.patient || retry_due(&k->patience);
    for (int b = 0; b < BAND_COUNT && due && status == STATUS_OK; b++)
        if (k->file[b]) status = put_band(k, (Band)b, frame);
    if (!k->of.patient) return status;
    retry_done(&k->patience, due, due ? status : STATUS_IO);
    for (int b = 0; b < BAND_COUNT; b++)
        if (k->file[b]) clearerr(k->file[b]);
    return STATUS_OK;
}

static Status close_klv(Consumer *consumer)
{
    KlvConsumer *k = (KlvConsumer *)consumer;
    Status       status = STATUS_OK;
    for (int b = 0; b < BAND_COUNT; b++)
        if (k->file[b] && fclose(k->file[b]) != 0 && !k->of.patient) {
            log_error("klv: cannot write metadata: %s", strerror(errno));
            status = STATUS_IO;
        }
    free(k);
    return status;
}

bool klv_geoid_open(Geoid *out, const Config *config)
{
    log_suppress(true); /* its message is that of a terrain, which cannot do without */
    const bool found = geoid_open(out, config->terrain.geoid) == STATUS_OK;
    log_suppress(false);
    if (!found)
        log_info("klv: no grid of the geoid: metadata has heights above the ellipsoid only; install proj-data or set "
                 "terrain.geoid");
    return found;
}

static Status begin(Consumer *consumer)
{
    KlvConsumer *k = (KlvConsumer *)consumer;
    char         path[frame_path_size];
    for (int b = 0; b < BAND_COUNT; b++) {
        if (!(k->of.bands >> b & 1)) continue;
        const bool fits = snprintf(path, sizeof path, "%s/%s.klv", k->of.out, band_name((Band)b)) < (int)sizeof path;
        if (!fits) errno = ENAMETOOLONG;
        k->file[b] = fits ? output_file(path, 0) : NULL;
        if (k->file[b]) continue;
        log_error("klv: cannot write %s: %s; choose another place with --out", path, output_reason(errno));
        return STATUS_IO;
    }
    return STATUS_OK;
}

Status consume_klv(Consumer **out, const KlvFiles *of)
{
    KlvConsumer *k = calloc(1, sizeof *k);
    if (!k) return STATUS_NO_MEMORY;
    const bool truth = of->config->publish.vmti == VMTI_TRUTH;
    k->of = *of;
    k->found = (KlvAnswers){.from = of->answers};
    k->patience = (RetryBackoff){.what = "packets in .klv files"};
    k->consumer = (Consumer){WANT_FOOTPRINT | (truth ? WANT_TARGETS : 0), put, NULL, close_klv, "klv", begin};
    *out = &k->consumer;
    return STATUS_OK;
}
