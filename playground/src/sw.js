// Keeps the page for when there is no network: what belongs to this build is fetched once and served from then on; a new
// build has another version, and the old one's files go.
const VERSION = 'skein-@VERSION@', FILES = JSON.parse('@FILES@');
const NEEDED = FILES.filter((name) => !/[.](png|obj|off|node|ele)$/.test(name)); // the rest comes when it is free

addEventListener('install', (event) => {
    event.waitUntil(caches.open(VERSION).then((cache) => cache.addAll(NEEDED)).then(() => skipWaiting()));
});
addEventListener('activate', (event) => {
    const clean = async () => {
        for (const name of await caches.keys()) if (name.startsWith('skein-') && name !== VERSION) await caches.delete(name);
        await clients.claim();
    };
    event.waitUntil(clean());
});
addEventListener('message', (event) => {
    if (event.data !== 'all') return;
    const rest = async () => {
        const cache = await caches.open(VERSION);
        for (const name of FILES) if (!(await cache.match(name))) await cache.add(name).catch(() => {});
        event.source?.postMessage('offline');
    };
    event.waitUntil(rest());
});
/* What it serves is isolated from other pages, so that the page may share memory with threads, whatever the server sends. */
function isolated(answer) {
    if (answer.status === 0 || answer.type === 'opaque') return answer;
    const headers = new Headers(answer.headers);
    headers.set('Cross-Origin-Opener-Policy', 'same-origin');
    headers.set('Cross-Origin-Embedder-Policy', 'require-corp');
    headers.set('Cross-Origin-Resource-Policy', 'cross-origin'); // <skein-scene> is welcome everywhere
    return new Response(answer.body, {status: answer.status, statusText: answer.statusText, headers});
}
addEventListener('fetch', (event) => {
    if (event.request.method !== 'GET' || new URL(event.request.url).origin !== location.origin) return;
    event.respondWith(caches.match(event.request, {ignoreSearch: true}).then((kept) => kept ?? fetch(event.request)).then(isolated));
});
