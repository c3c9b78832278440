/* sensor/publish/klv/consume_klv.c: packets of metadata with the targets that publish.vmti asks for, and the consumer
 * that writes them into files, one a band. */
#include "sensor/publish/klv/consume_klv.h"
#include "pitviper_output.h"
#include "sensor/publish/files/frame_files.h"

#include <errno.h>
#include <stdlib.h>

/* ---- targets of the metadata, from detections or truth ------------------------------------------- */

void klv_of_detections(KlvTargets *out, KlvTarget kept[klv_most_targets], const DetectionSet *set)
{
    _Static_assert((int)pitviper_detections_most <= (int)klv_most_targets, "all of a datagram are in one packet");
    *out =
        (KlvTargets){.count = set->count, .target = kept, .elsewhen = true, .frame = set->frame, .unix_s = set->unix_s};
    for (int k = 0; k < set->count; k++) {
        const PitviperDetection *d = &set->detection[k];
        kept[k] =
            (KlvTarget){.id = d->track ? d->track : ((uint64_t)1 << 32) + (uint64_t)k,
                        .box = {(int)floorf(d->left), (int)floorf(d->top), (int)ceilf(d->right), (int)ceilf(d->bottom)},
                        .confidence = d->score,
                        .pixels = NAN,
                        .class_name = d->class_name};
    }
}

/* The targets of a frame; NULL: none are known. Valid until the next call. */
static const KlvTargets *klv_detections(KlvDetections *k, const Frame *frame, Band band)
{
    if (!k->from || !detections_latest(k->from, band, &k->set)) return NULL;
    if (!(fabs(frame->unix_s - k->set.unix_s) <= klv_detections_s)) return NULL;
    klv_of_detections(&k->targets, k->kept, &k->set);
    return &k->targets;
}

size_t klv_of_band(uint8_t out[klv_most_octets], KlvDetections *k, enum VmtiSource vmti, const Frame *frame, Band band,
                   const Geoid *geoid)
{
    const KlvSource   source = {.band = band, .geoid = geoid};
    const KlvTargets *targets = NULL;
    if (vmti == VMTI_TRUTH) {
        klv_truth_targets(&k->targets, k->kept, &frame->record);
        targets = &k->targets;
    } else if (vmti == VMTI_ATR) {
        targets = klv_detections(k, frame, band);
    }
    return klv_frame(out, &frame->record, frame->unix_s, &source, targets);
}

/* ---- the consumer -------------------------------------------------------------------------------- */

typedef struct KlvConsumer {
    Consumer      consumer;
    FILE         *file[BAND_COUNT];
    KlvFiles      of;
    KlvDetections found;
    RetryBackoff  patience;
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
    k->found = (KlvDetections){.from = of->detections};
    k->patience = (RetryBackoff){.what = "packets in .klv files"};
    k->consumer = (Consumer){WANT_FOOTPRINT | (truth ? WANT_TARGETS : 0), put, NULL, close_klv, "klv", begin};
    *out = &k->consumer;
    return STATUS_OK;
}
