/* sensor/instruments/instruments.c: the kinds of instruments, and lists of instruments. */
#include "sensor/instruments/camera.h"
#include "sensor/instruments/radar.h"

const InstrumentKind *const instrument_kinds[] = {&camera_kind, &radar_kind, NULL};

Status instruments_open(Instruments *list, const InstrumentKind *const kind[], const InstrumentsOf *of)
{
    Status status = STATUS_OK;
    for (int k = 0; kind[k] && status == STATUS_OK; k++) status = kind[k]->open(list, of);
    return status;
}

void instruments_close(Instruments *list)
{
    for (int i = 0; i < list->count; i++) list->instrument[i]->kind->close(list->instrument[i]);
    list->count = 0;
}

Status instruments_add(Instruments *list, Instrument *instrument)
{
    if (list->count == instruments_most) {
        log_error("instruments: %s is one too many: a session has at most %d", instrument->name, instruments_most);
        instrument->kind->close(instrument);
        return STATUS_BAD_VALUE;
    }
    list->instrument[list->count++] = instrument;
    return STATUS_OK;
}

Instrument *instruments_find(const Instruments *list, const InstrumentKind *kind)
{
    for (int i = 0; i < list->count; i++)
        if (list->instrument[i]->kind == kind) return list->instrument[i];
    return NULL;
}

void instruments_request(RenderRequest *request, const Instruments *list, unsigned wants)
{
    for (int i = 0; i < list->count; i++)
        if (list->instrument[i]->kind->request) list->instrument[i]->kind->request(request, list->instrument[i], wants);
}

Status instruments_look(const Instruments *list, const InstrumentLook *look)
{
    Frame *frame = look->frame;
    Status status = STATUS_OK;
    for (frame->outputs = 0; frame->outputs < list->count && status == STATUS_OK; frame->outputs++) {
        Instrument           *one = list->instrument[frame->outputs];
        const InstrumentKind *kind = one->kind;
        FrameOutput          *out = &frame->output[frame->outputs];
        *out = (FrameOutput){.name = one->name, .kind = kind};
        if (look->noted == INSTRUMENT_ABSENT && kind->noted) out->left_out = kind->noted;
        else status = kind->look(out, one, look);
    }
    return status;
}

Status instruments_prepare(const Instruments *list, const Catalog *catalog, const Snapshot *snapshot)
{
    Status status = STATUS_OK;
    for (int i = 0; i < list->count && status == STATUS_OK; i++) {
        Instrument *one = list->instrument[i];
        if (one->kind->prepare) status = one->kind->prepare(one, catalog, snapshot);
    }
    return status;
}

InstrumentReady instruments_ready(const Instruments *list)
{
    InstrumentReady all = {0};
    for (int i = 0; i < list->count; i++) {
        const Instrument     *one = list->instrument[i];
        const InstrumentReady ready = one->kind->ready ? one->kind->ready(one) : (InstrumentReady){0};
        all.made += ready.made;
        all.waiting += ready.waiting;
    }
    return all;
}

void instruments_count(InstrumentCount count[instruments_most], const Frame *frame)
{
    for (int i = 0; i < frame->outputs; i++) {
        const FrameOutput *out = &frame->output[i];
        count[i].kind = out->kind;
        count[i].name = out->name;
        count[i].coarse += out->coarse;
        if (!out->left_out) continue;
        count[i].why = out->left_out;
        count[i].left_out++;
    }
}

int instruments_left_out(const InstrumentCount count[instruments_most], const InstrumentKind *kind)
{
    int frames = 0;
    for (int i = 0; i < instruments_most; i++)
        if (count[i].kind == kind) frames += count[i].left_out;
    return frames;
}

int instruments_coarse(const InstrumentCount count[instruments_most], const InstrumentKind *kind)
{
    int frames = 0;
    for (int i = 0; i < instruments_most; i++)
        if (count[i].kind == kind) frames += count[i].coarse;
    return frames;
}
