/* sensor/verify/saved_frame/saved_frame.c: a complete frame file: its chunks, in order, and the consistency between
 * them. */
#include "sensor/verify/saved_frame/saved_frame.h"

#include "sensor/verify/saved_frame/saved_frame_private.h"

/* ---- chunks ------------------------------------------------------------------------------------- */

typedef void ChunkFields(Fields *f, SavedFrame *file);

static bool has_marks(const SavedFrame *file)
{
    const GroundMarks *m = &file->snapshot.marks;
    return m->stands > 0 || m->tracks > 0 || m->burns > 0 || m->forgotten > 0;
}

static bool has_woods(const SavedFrame *file) { return file->planted; }
static bool has_scenery(const SavedFrame *file) { return file->built; }
static bool has_shows(const SavedFrame *file)
{
    const SceneryPlan *plan = &file->scenery.plan;
    return file->built && (plan->lamps || plan->smoke || plan->harms > 0);
}
static bool has_radar(const SavedFrame *file) { return file->measured; }
static bool has_coarse(const SavedFrame *file) { return file->measured && file->radar.coarse; }

static const struct Chunk {
    const char  *name;
    ChunkFields *fields;                      /* NULL: the ground, which may be a cut-out */
    bool (*is_there)(const SavedFrame *file); /* NULL: in every file */
} chunks[] = {
    {"about", saved_fields_about, NULL},
    {"settings", saved_fields_settings, NULL},
    {"tables", saved_fields_tables, NULL},
    {"models", saved_fields_models, NULL},
    {"snapshot", saved_fields_snapshot, NULL},
    {"request", saved_fields_request, NULL},
    {"planes", saved_fields_planes, NULL},
    {"ground", NULL, NULL},
    {"woods", saved_fields_woods, has_woods},
    {"marks", saved_fields_marks, has_marks},
    {"scenery", saved_fields_scenery, has_scenery},
    {"shows", saved_fields_shows, has_shows},
    {"radar", saved_fields_radar, has_radar},
    {"coarse", saved_fields_coarse, has_coarse},
};
enum { chunk_kinds = sizeof chunks / sizeof *chunks };

Status saved_frame_pack(ByteSink *out, const SavedFrame *file, const GroundCutout *kept)
{
    SavedFrame fields = *file; /* the list of fields takes a mutable value, for reading */
    chunks_begin(out);
    for (int c = 0; c < chunk_kinds; c++) {
        ByteSink content = {0};
        Fields   f = {.to = &content, .version = chunks_version};
        if (chunks[c].is_there && !chunks[c].is_there(file)) continue;
        if (chunks[c].fields) chunks[c].fields(&f, &fields);
        else saved_fields_ground(&f, &fields, kept);
        chunks_put(out, chunks[c].name, &content);
        sink_free(&content);
    }
    chunks_end(out);
    return out->failed ? STATUS_NO_MEMORY : STATUS_OK;
}

/* ---- consistency ---------------------------------------------------------------------------- */

static const SavedModel *model_of(const SavedFrame *file, int model)
{
    for (int i = 0; i < file->model_count; i++)
        if (file->model[i].model == model) return &file->model[i];
    return NULL;
}

/* Checks the indices that one chunk has into another. NULL: they agree; else the reason. */
static const char *disagreement(const SavedFrame *file)
{
    const Snapshot *s = &file->snapshot;
    if (file->request.hidden_entity >= s->count || file->eye.host_index >= s->count)
        return "the host is not in the snapshot";
    for (int e = 0; e < s->count; e++) {
        const SavedModel *model = s->entity[e].model < 0 ? NULL : model_of(file, s->entity[e].model);
        if (s->entity[e].model >= 0 && !model) return "an entity's model is not listed";
        if (model && model->node_count > s->node_count - s->entity[e].first_node) return "an entity has too few nodes";
    }
    if (file->measured && file->radar.joint_count != s->node_count)
        return "the radar has other joints than the snapshot";
    if ((file->request.bands >> BAND_RADAR & 1) && file->request.profile_bins > 0 && !(file->request.profile_bin_m > 0))
        return "the range profile has no bins";
    return NULL;
}

/* field: the one that is out of its range; NULL: something else is wrong. */
static Status parse(SavedFrame *out, ChunkSource *source, unsigned *met, const char **field)
{
    char       name[chunk_name_size + 1];
    ByteSource content;
    for (;;) {
        const Status status = chunks_next(source, name, &content);
        if (status != STATUS_OK || !*name) return status;
        int c = 0;
        while (c < chunk_kinds && strcmp(chunks[c].name, name) != 0) c++;
        if (c == chunk_kinds) continue; /* of a later version, with a field that this one need not know */
        Fields f = {.from = &content, .arena = source->arena, .version = source->version};
        if (*met >> c & 1) source->fault = "a chunk is there twice";
        else if (chunks[c].fields) chunks[c].fields(&f, out);
        else if (sha256_bytes(out->ground_sha256, content.at, (size_t)(content.end - content.at)) != STATUS_OK)
            return STATUS_NO_MEMORY;
        else saved_fields_ground(&f, out, NULL);
        *met |= 1u << c;
        *field = f.fault;
        if (f.no_memory) return STATUS_NO_MEMORY;
        if (!f.fault && content.truncated) source->fault = "a chunk ends too early";
        if (!f.fault && !source->fault && content.at != content.end) source->fault = "a chunk is too long";
        if (f.fault || source->fault) return STATUS_BAD_VALUE;
    }
}

Status saved_frame_parse(SavedFrame *out, const uint8_t *bytes, size_t count, const char *path, Arena *arena)
{
    ChunkSource source;
    unsigned    met = 0;
    const char *field = NULL;
    *out = (SavedFrame){0};
    Status status = chunks_open(&source, bytes, count, arena);
    if (status == STATUS_OK) status = parse(out, &source, &met, &field);
    for (int c = 0; c < chunk_kinds; c++) met |= (chunks[c].is_there ? 1u : 0u) << c;
    if (status == STATUS_OK && met != (1u << chunk_kinds) - 1) {
        int c = 0;
        while (met >> c & 1) c++;
        log_error("frame: %s has no chunk `%s`; it is not a complete frame file", path, chunks[c].name);
        return STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK && (source.fault = disagreement(out))) status = STATUS_BAD_VALUE;
    if (status == STATUS_NO_MEMORY) log_error("frame: %s: out of memory", path);
    else if (status != STATUS_OK)
        log_error("frame: %s cannot be read: %s%s; save it again with `pitviper replay LOG --save-frame N`", path,
                  field ? "out of range: " : "",
                  field          ? field
                  : source.fault ? source.fault
                                 : status_name(status));
    return status;
}

/* ---- models ------------------------------------------------------------------------------------- */

/* Field by field: padding and pointers are not hashed. */
Status saved_model_sha256(char out[sha256_text_size], const Model *model)
{
    ByteSink s = {0};
    for (int n = 0; n < model->node_count; n++) {
        const ModelNode *node = &model->node[n];
        sink_text(&s, node->name);
        sink_bytes(&s, &node->parent, sizeof node->parent);
        sink_bytes(&s, node->p_parent, 3 * sizeof(double));
        sink_bytes(&s, node->r_parent_from_node, 9 * sizeof(double));
    }
    for (int p = 0; p < model->part_count; p++) {
        const ModelPart *part = &model->part[p];
        const int        number[4] = {part->node, (int)part->role, part->first_triangle, part->triangle_count};
        sink_text(&s, part->name);
        sink_text(&s, part->material);
        sink_bytes(&s, number, sizeof number);
        sink_bytes(&s, &(uint32_t){part->damage_hidden}, sizeof(uint32_t));
        for (int d = 0; d < model_damage_states; d++) sink_text(&s, part->damage_material[d]);
    }
    const size_t vertices = (size_t)model->vertex_count, triangles = (size_t)model->triangle_count;
    sink_bytes(&s, model->vertex, vertices * sizeof *model->vertex);
    sink_bytes(&s, model->normal, vertices * sizeof *model->normal);
    sink_bytes(&s, model->triangle, triangles * sizeof *model->triangle);
    sink_bytes(&s, model->triangle_part, triangles * sizeof *model->triangle_part);
    const Status status = s.failed ? STATUS_NO_MEMORY : sha256_bytes(out, s.bytes, s.count);
    sink_free(&s);
    return status;
}
