/* Threads of your own: a program that has a pool of workers gives Skein those, and no other thread is made. The result
 * does not depend on how many there are. */
#include <pthread.h>
#include <skein/skein.h>
#include <stdio.h>

enum { WORKERS = 3 };

/* One job at a time: its tasks are handed out by number, to the workers and to whoever asked. */
typedef struct pool {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    void (*task)(void *data, int index);
    void *data;
    int next, count, done;
    bool closing;
} pool;

/* Does tasks as long as there are; the lock is held before and after. */
static void work(pool *p) {
    while (p->next < p->count) {
        int index = p->next++;
        void (*task)(void *data, int index) = p->task;
        void *data = p->data;
        pthread_mutex_unlock(&p->lock);
        task(data, index);
        pthread_mutex_lock(&p->lock);
        if (++p->done == p->count) pthread_cond_broadcast(&p->changed);
    }
}

static void *worker(void *user) {
    pool *p = user;
    pthread_mutex_lock(&p->lock);
    while (!p->closing) {
        work(p);
        if (!p->closing) pthread_cond_wait(&p->changed, &p->lock);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

/* What Skein calls: returns when all tasks are done. */
static void run_tasks(void *user, void (*task)(void *data, int index), void *data, int count) {
    pool *p = user;
    pthread_mutex_lock(&p->lock);
    p->task = task, p->data = data, p->next = 0, p->count = count, p->done = 0;
    pthread_cond_broadcast(&p->changed);
    work(p);
    while (p->done < p->count) pthread_cond_wait(&p->changed, &p->lock);
    p->next = p->count = 0;
    pthread_mutex_unlock(&p->lock);
}

/* The hash of a second of a falling cloth; 0: it failed. */
static uint64_t fall(const skein_world_desc *desc) {
    const skein_setting cloth[] = {SKEIN_PAIR("grid", 97, 97), SKEIN_TEXT("pins", "corners"), SKEIN_END};
    skein_world *world = skein_world_create(desc, NULL);
    bool good =
        world && !skein_body_add(world, "cloth", NULL, cloth, NULL) && !skein_force_add(world, "gravity", NULL, NULL);
    for (int i = 0; i < 60 && good; i++) good = !skein_world_step(world, SKEIN_DEFAULT_STEP);
    uint64_t hash = good ? skein_world_hash(world) : 0;
    skein_world_destroy(world);
    return hash;
}

int main(void) {
    static pool p = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};
    pthread_t threads[WORKERS];
    int started = 0;
    while (started < WORKERS && !pthread_create(&threads[started], NULL, worker, &p)) started++;

    skein_world_desc desc = skein_default_world_desc();
    desc.run_tasks = run_tasks;
    desc.tasks_user = &p;
    desc.thread_count = WORKERS + 1; /* as many tasks at once */
    uint64_t ours = fall(&desc);
    pthread_mutex_lock(&p.lock);
    p.closing = true;
    pthread_cond_broadcast(&p.changed);
    pthread_mutex_unlock(&p.lock);
    for (int t = 0; t < started; t++) pthread_join(threads[t], NULL);

    desc = skein_default_world_desc();
    desc.thread_count = 1;
    uint64_t alone = fall(&desc);
    printf("on %d threads of our own and on one: %s\n", WORKERS + 1,
           ours && ours == alone ? "the same bits" : "other bits");
    return !(ours && ours == alone);
}
