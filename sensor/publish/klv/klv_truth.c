/* sensor/publish/klv/klv_truth.c: the targets of a frame's truth as targets of the metadata, marked as truth. */
#include "sensor/publish/klv/klv.h"

#include "sensor/publish/target_class.h"

static KlvTarget truth_target(const TargetRecord *t)
{
    const DisEntityId id  = t->id;
    KlvTarget         out = {.id = (uint64_t)id.site << 32 | (uint64_t)id.application << 16 | id.entity,
                             .confidence = NAN, .pixels = t->pixels, .algorithm = "truth",
                             .algorithm_version = PITVIPER_VERSION, .class_name = target_class_name(t->class_number)};
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
        if (!(t->pixels > 0) || box_is_empty(t->box)) continue;
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
