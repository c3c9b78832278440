/* sensor/publish/klv/klv_detections.c: detections received from a recogniser as targets of the metadata. */
#include "sensor/publish/klv/klv_detections.h"

void klv_of_detections(KlvTargets *out, KlvTarget kept[klv_most_targets], const DetectionSet *set)
{
    _Static_assert((int)pitviper_detections_most <= (int)klv_most_targets, "all of a datagram are in one packet");
    *out = (KlvTargets){.count = set->count, .target = kept, .elsewhen = true, .frame = set->frame,
                        .unix_s = set->unix_s};
    for (int k = 0; k < set->count; k++) {
        const PitviperDetection *d = &set->detection[k];
        kept[k] = (KlvTarget){.id = d->track ? d->track : ((uint64_t)1 << 32) + (uint64_t)k,
                              .box = {(int)floorf(d->left), (int)floorf(d->top), (int)ceilf(d->right),
                                      (int)ceilf(d->bottom)},
                              .confidence = d->score, .pixels = NAN, .class_name = d->class_name};
    }
}

const KlvTargets *klv_detections(KlvDetections *k, const Frame *frame, Band band)
{
    if (!k->from || !detections_latest(k->from, band, &k->set)) return NULL;
    if (!(fabs(frame->unix_s - k->set.unix_s) <= klv_detections_s)) return NULL;
    klv_of_detections(&k->targets, k->kept, &k->set);
    return &k->targets;
}

size_t klv_of_band(uint8_t out[klv_most_octets], KlvDetections *k, const char *vmti, const Frame *frame, Band band,
                   const Geoid *geoid)
{
    const KlvSource   source  = {.band = band, .geoid = geoid};
    const KlvTargets *targets = NULL;
    if (strcmp(vmti, "truth") == 0) {
        klv_truth_targets(&k->targets, k->kept, &frame->record);
        targets = &k->targets;
    } else if (strcmp(vmti, "atr") == 0) {
        targets = klv_detections(k, frame, band);
    }
    return klv_frame(out, &frame->record, frame->unix_s, &source, targets);
}
