/* Which leaves may meet, found by the tree of their boxes. */
#include <string.h>

#include "base/tasks.h"
#include "contact/search/search.h"

/* ---- boxes of the tree ---- */

/* Puts a box into a slot. */
static void put_box(sk_tree_block *block, size_t lane, const sk_box *box) {
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) {
            block->low[end][k][lane] = box->low[end][k];
            block->high[end][k][lane] = box->high[end][k];
        }
}

/* A level of the tree, and of how many slots it is: leaves, or blocks of the level below. */
typedef struct fitting {
    sk_touch *touch;
    int level;
    size_t count;
    uint8_t *changed; /* whether slots are new; */
    uint8_t *above;   /* and those of the next level are */
} fitting;

/* Puts those of a block's boxes in that are new; whether there are any. */
static bool fit_block(const fitting *job, size_t b) {
    const sk_touch *touch = job->touch;
    const sk_tree *tree = &touch->tree;
    const sk_quad most = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX, 0};
    const sk_box nothing = {{most, most}, {-most, -most}};
    const int level = job->level;
    size_t first = b * SK_TREE_WIDTH;
    bool any = touch->refit;
    if (!any && first + SK_TREE_WIDTH <= job->count && !memchr(job->changed + first, 1, SK_TREE_WIDTH)) return false;
    for (size_t l = 0, i = first; l < SK_TREE_WIDTH; l++, i++) {
        if (i < job->count && !job->changed[i]) continue;
        if (i >= job->count && !touch->refit) continue;
        sk_box below = level && i < job->count ? sk_box_around(&tree->block[level - 1][i]) : nothing;
        put_box(&tree->block[level][b], l, level || i >= job->count ? &below : &touch->leaf_box[tree->leaf_at[i]]);
        any = true;
    }
    return any;
}

static void fit_blocks(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const fitting *job = data;
    const sk_touch *touch = job->touch;
    for (size_t i = begin * SK_TREE_WIDTH; i < end * SK_TREE_WIDTH && i < job->count && !job->level; i++)
        job->changed[i] = touch->moved[touch->tree.leaf_at[i]] | touch->refit;
    for (size_t b = begin; b < end; b++) job->above[b] = fit_block(job, b);
}

/* Puts leaves' boxes that are new into the tree, and the boxes of their blocks into the levels above. */
static void fit(sk_touch *touch) {
    enum { BLOCKS_AT_ONCE = 64 };
    sk_tree *tree = &touch->tree;
    size_t leaves = touch->skin.leaf_count + 1;
    fitting job = {
        .touch = touch, .count = touch->skin.leaf_count, .changed = touch->changed, .above = touch->changed + leaves};
    for (; job.level < tree->levels; job.level++) {
        sk_parallel_pieces(touch->tasks, 0, tree->blocks[job.level], BLOCKS_AT_ONCE, fit_blocks, &job);
        uint8_t *above = job.above;
        job.count = tree->blocks[job.level];
        job.above = job.changed;
        job.changed = above;
    }
    touch->refit = false;
}

/* ---- partners ---- */

/* The leaves of a block that are looked for, and the box around them. */
typedef struct looking_block {
    size_t number;
    uint32_t lanes;
    sk_box box;
} looking_block;

static looking_block block_at(const sk_touch *touch, size_t number) {
    const sk_quad most = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX, 0};
    looking_block block = {.number = number, .box = {{most, most}, {-most, -most}}};
    for (size_t l = 0, slot = number * SK_TREE_WIDTH; l < SK_TREE_WIDTH && slot < touch->skin.leaf_count; l++, slot++) {
        uint32_t leaf = touch->tree.leaf_at[slot];
        if (!touch->anew[leaf]) continue;
        block.lanes |= 1u << l;
        sk_box_widen(&block.box, &touch->hot_box[leaf]);
    }
    return block;
}

/* Notes which leaves lie around those of a block. */
static void mark_rings(const sk_touch *touch, sk_ring_mark *mark, const looking_block *block) {
    const sk_calm *calm = &touch->calm;
    for (uint32_t lanes = block->lanes; lanes; lanes &= lanes - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(lanes), a = touch->tree.leaf_at[block->number * SK_TREE_WIDTH + lane];
        for (uint32_t i = calm->ring_start[a]; i < calm->ring_start[a + 1]; i++) {
            sk_ring_mark *m = &mark[calm->ring[i]];
            if (m->block != block->number + 1) *m = (sk_ring_mark){(uint32_t)block->number + 1, 0};
            m->lanes |= 1u << lane;
        }
    }
}

/* Whether two leaves are to be listed. Of two that are both looked for, one lists the other: where everybody is, the one in
 * the lower slot; else the first of both. */
static bool are_partners(const sk_parts_job *job, const sk_ring_mark *mark, const looking_block *block, uint32_t lane,
                         uint32_t a, uint32_t b) {
    const sk_touch *touch = job->touch;
    bool around = mark[b].block == block->number + 1 && (mark[b].lanes >> lane & 1);
    if (around && !job->calm_too && touch->calm.patch[touch->calm.of_leaf[b < a ? b : a]].calm) return false;
    if (sk_is_ignored(&touch->ignored, a, b)) return false;
    return touch->everybody || b >= a || !touch->anew[b] || !sk_boxes_meet(&touch->hot_box[b], &touch->leaf_box[a]);
}

/* Lists those that the leaves of a block may meet, themselves too. False when there is no room. */
static bool list_partners(const sk_parts_job *job, sk_search_part *part, const looking_block *block) {
    const sk_touch *touch = job->touch;
    const uint32_t *leaf_at = touch->tree.leaf_at;
    uint32_t hit[SK_TREE_WIDTH * SK_TREE_WIDTH];
    size_t a = block->number, before = part->first.count;
    mark_rings(touch, part->ring, block);
    size_t blocks = sk_tree_blocks[touch->isa](&touch->tree, &block->box, touch->everybody ? a : 0, part->block);
    for (size_t k = 0; k < blocks; k++) {
        size_t b = part->block[k];
        size_t count =
            sk_tree_hits[touch->isa](&touch->tree, a, b, block->lanes, touch->hot_box, touch->everybody, hit);
        // (a list may have grown when there was no memory for the other)
        if (part->first.count + count > part->first.capacity || part->first.count + count > part->second.capacity) {
            part->first.count = part->second.count = before;
            return false;
        }
        for (size_t i = 0; i < count; i++) {
            uint32_t lane = hit[i] >> SK_TREE_SHIFT, one = leaf_at[a * SK_TREE_WIDTH + lane];
            uint32_t two = leaf_at[b * SK_TREE_WIDTH + hit[i] % SK_TREE_WIDTH];
            if (!are_partners(job, part->ring, block, lane, one, two)) continue;
            part->first.data[part->first.count++] = two < one ? two : one;
            part->second.data[part->second.count++] = two < one ? one : two;
        }
    }
    return true;
}

static void list_part(const sk_parts_job *job, sk_search_part *part) {
    for (; part->next < part->end; part->next++) {
        looking_block block = block_at(job->touch, part->next);
        if (part->first.count > job->most) part->next = part->end - 1; // too many in all
        else if (block.lanes && !list_partners(job, part, &block)) return;
    }
}

static bool grow_lists(sk_search_part *part, sk_allocator *allocator) {
    const size_t more = 1024;
    size_t need = 2 * part->first.capacity + part->end * SK_TREE_WIDTH + more;
    return SK_RESERVE(allocator, &part->first, need) && SK_RESERVE(allocator, &part->second, need);
}

/* Some leaves, no two of which are the same. Of few each is put where so many are less, which takes no branch. */
static void put_in_order(uint32_t *data, size_t count) {
    enum { FEW = 48 };
    if (count <= FEW) {
        uint32_t old[FEW];
        memcpy(old, data, count * sizeof *old);
        for (size_t i = 0; i < count; i++) {
            int32_t less = 0;
            for (size_t k = 0; k < count; k++) less += (int32_t)old[k] < (int32_t)old[i];
            data[less] = old[i];
        }
        return;
    }
    for (size_t i = 1; i < count; i++) {
        uint32_t b = data[i];
        size_t to = i;
        for (; to && data[to - 1] > b; to--) data[to] = data[to - 1];
        data[to] = b;
    }
}

/* Room for all blocks and leaves that there are, in each part. */
static bool begin_parts(sk_touch *touch, sk_allocator *allocator) {
    for (int i = 0; i < SK_MOST_PARTS; i++) {
        sk_search_part *part = &touch->part[i];
        part->first.count = part->second.count = 0;
        bool used = i == 0 || (touch->tasks && i < sk_tasks_count(touch->tasks));
        if (used && !part->block &&
            !(part->block = sk_allocate(allocator, (touch->tree.blocks[0] + 1) * sizeof *part->block)))
            return false;
        if (used && !part->ring &&
            !(part->ring = sk_allocate(allocator, (touch->skin.leaf_count + 1) * sizeof *part->ring)))
            return false;
        if (used && !part->start &&
            !(part->start = sk_allocate(allocator, (touch->skin.leaf_count + 1) * sizeof *part->start)))
            return false;
    }
    return true;
}

/* Few are put where they belong one by one. */
static void insert_few(sk_touch *touch) {
    uint32_t *first = touch->first.data, *second = touch->partner.data;
    size_t count = 0;
    for (int p = 0; p < touch->part_count; p++)
        for (size_t i = 0; i < touch->part[p].first.count; i++) {
            uint32_t a = touch->part[p].first.data[i], b = touch->part[p].second.data[i];
            size_t to = count++;
            for (; to && (first[to - 1] > a || (first[to - 1] == a && second[to - 1] > b)); to--)
                first[to] = first[to - 1], second[to] = second[to - 1];
            first[to] = a, second[to] = b;
        }
}

/* Counts those of a part by their first leaf. */
static void count_of_part(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const sk_touch *touch = data;
    for (size_t p = begin; p < end; p++) {
        const sk_search_part *part = &touch->part[p];
        memset(part->start, 0, (touch->skin.leaf_count + 1) * sizeof *part->start);
        for (size_t i = 0; i < part->first.count; i++) part->start[part->first.data[i]]++;
    }
}

/* Puts those of a part where those of their first leaf belong, behind those of the parts before it. */
static void deal_part(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const sk_touch *touch = data;
    for (size_t p = begin; p < end; p++) {
        const sk_search_part *part = &touch->part[p];
        for (size_t i = 0; i < part->first.count; i++)
            touch->partner.data[part->start[part->first.data[i]]++] = part->second.data[i];
    }
}

static void sort_of_leaves(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const sk_touch *touch = data;
    const uint32_t *start = touch->start;
    for (size_t a = begin; a < end; a++) {
        put_in_order(touch->partner.data + start[a], start[a + 1] - start[a]);
        for (size_t i = start[a]; i < start[a + 1]; i++) touch->first.data[i] = (uint32_t)a;
    }
}

/* Many are counted by their first leaf, and those of a leaf are sorted. */
static void deal_many(sk_touch *touch) {
    enum { LEAVES_AT_ONCE = 512 };
    size_t leaves = touch->skin.leaf_count, parts = (size_t)touch->part_count;
    uint32_t count = 0;
    sk_parallel_pieces(touch->tasks, 0, parts, 1, count_of_part, touch);
    for (size_t a = 0; a < leaves; a++) {
        touch->start[a] = count;
        for (size_t p = 0; p < parts; p++) {
            uint32_t *start = &touch->part[p].start[a], of_part = *start;
            *start = count, count += of_part;
        }
    }
    touch->start[leaves] = count;
    sk_parallel_pieces(touch->tasks, 0, parts, 1, deal_part, touch);
    sk_parallel_pieces(touch->tasks, 0, leaves, LEAVES_AT_ONCE, sort_of_leaves, touch);
}

bool sk_touch_partners(sk_touch *touch, sk_allocator *allocator, size_t most, bool calm_too, bool *too_many) {
    const size_t worth = 32, few = 128; // blocks; pairs of leaves
    size_t count = 0;
    sk_parts_job job = {
        .touch = touch, .most = most, .calm_too = calm_too, .at_once = 8, .work = list_part, .grow = grow_lists};
    fit(touch);
    if (!begin_parts(touch, allocator) || !sk_touch_work(&job, allocator, touch->tree.blocks[0], worth)) return false;
    for (int i = 0; i < touch->part_count; i++) count += touch->part[i].first.count;
    touch->partner.count = touch->first.count = 0;
    *too_many = count > most;
    if (*too_many) return true;
    if (!SK_RESERVE(allocator, &touch->partner, count + 1) || !SK_RESERVE(allocator, &touch->first, count + 1))
        return false;
    touch->partner.count = touch->first.count = count;
    if (count < few) insert_few(touch);
    else deal_many(touch);
    return true;
}
