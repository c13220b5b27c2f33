// The console's stream of events, and single flights. Whoever is slow gets the newest, not all.
const kSilence_ms = 6000;  // the server says something every two seconds
const kKeptFlights_n = 6;

export function listen({ on_cell, on_servers, on_link }) {
  let source = null;
  let heard_at = 0;
  let was_lost = false;
  const open = () => {
    source?.close();
    source = new EventSource('api/events');
    heard_at = Date.now();
    const heard = () => {
      heard_at = Date.now();
      on_link('live', was_lost);
      was_lost = false;
    };
    source.addEventListener('alive', heard);
    source.addEventListener('cell', (event) => on_cell(JSON.parse(event.data)));
    source.addEventListener('servers', (event) => on_servers(JSON.parse(event.data)));
    source.onerror = () => {
      was_lost = true;
      on_link('lost');
      source.close();
      setTimeout(open, 1000);
    };
  };
  setInterval(() => {
    if (Date.now() - heard_at < kSilence_ms) return;
    was_lost = true;
    on_link('lost');
    open();
  }, 1000);
  open();
}

async function get(path, parameters) {
  const response = await fetch(`api/${path}?${new URLSearchParams(parameters)}`);
  if (!response.ok) throw new Error((await response.text()).trim());
  return response;
}

export const get_history = async (cell) => (await get('history', { cell })).json();
export const get_triangles = async (id) => new Float32Array(await (await get('part', { id })).arrayBuffer());

const kept = new Map();
async function get_flight(name) {
  const known = kept.get(name);
  if (known) return known;
  const [flight, depth] = await Promise.all([
    get('flight', { name }).then((response) => response.json()),
    get('depth', { name }).then((response) => response.arrayBuffer()),
  ]);
  flight.name = name;
  flight.depth = new Uint16Array(depth);
  kept.set(name, flight);
  if (kept.size > kKeptFlights_n) kept.delete(kept.keys().next().value);
  return flight;
}

// Shows one flight at a time; of those asked for meanwhile, the last.
export function make_loader(show, fail) {
  let wanted = null;
  let is_busy = false;
  return async function load(name) {
    wanted = name;
    if (is_busy) return;
    is_busy = true;
    while (wanted) {
      const next = wanted;
      wanted = null;
      try {
        const flight = await get_flight(next);
        show(flight);
        // The screen gets its turn; one that draws slowly, without a GPU, does not hold up the plans.
        await Promise.race([new Promise(requestAnimationFrame), new Promise((turn) => setTimeout(turn, 40))]);
      } catch (error) {
        if (!wanted) fail(next, error);
      }
    }
    is_busy = false;
  };
}
