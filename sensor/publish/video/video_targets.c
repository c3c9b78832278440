/* sensor/publish/video/video_targets.c: a recogniser's detections as targets of a stream's metadata. */
#include "sensor/publish/video/video_targets.h"

static const double   most_age_s  = 0.5;
static const uint64_t first_other = (uint64_t)1 << 32; /* tracks are 32-bit numbers */

const KlvTargets *video_targets(VideoTargets *kept, Detections *detections, Band band, double unix_s)
{
    if (!detections_latest(detections, band, &kept->set)) return NULL;
    const double age_s = unix_s - kept->set.unix_s;
    if (!(age_s >= 0 && age_s <= most_age_s)) return NULL;
    const int count = kept->set.count < klv_most_targets ? kept->set.count : klv_most_targets;
    for (int i = 0; i < count; i++) {
        const PitviperDetection *d = &kept->set.detection[i];
        kept->target[i] = (KlvTarget){
            .id         = d->track ? d->track : first_other + (uint64_t)i + 1,
            .box        = {(int)floorf(d->left), (int)floorf(d->top), (int)ceilf(d->right), (int)ceilf(d->bottom)},
            .confidence = d->score,
            .pixels     = NAN,
            .class_name = *d->class_name ? d->class_name : NULL,
        };
    }
    kept->targets = (KlvTargets){.count = count, .total = kept->set.count, .target = kept->target};
    return &kept->targets;
}
