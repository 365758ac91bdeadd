// A server of static files, for tests: serve(folder, headers) -> {address, close}. With ISOLATED a page may share memory.
import {createServer} from 'node:http';
import {readFile} from 'node:fs/promises';
import {extname, join, normalize} from 'node:path';

const types = {'.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm', '.png': 'image/png'};

export const ISOLATED = {'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp'};

export async function serve(folder, headers = {}) {
    const server = createServer(async (request, answer) => {
        const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
        try {
            const body = await readFile(join(folder, path.endsWith('/') ? `${path}index.html` : path));
            answer.writeHead(200, {...headers, 'access-control-allow-origin': '*', 'content-type': types[extname(path)] ?? (path.endsWith('/') ? 'text/html' : 'text/plain')}).end(body);
        } catch {
            answer.writeHead(404).end();
        }
    });
    await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
    return {address: `http://127.0.0.1:${server.address().port}/`, close: () => server.close()};
}
