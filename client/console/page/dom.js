// Elements made in one expression; texts from outside only ever become text.
export function element(name, attributes = {}, ...children) {
  const made = name.startsWith('svg:')
    ? document.createElementNS('http://www.w3.org/2000/svg', name.slice(4))
    : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === 'text') made.textContent = value;
    else if (value !== undefined && value !== null && value !== false) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

export const by_id = (id) => document.getElementById(id);

export function set_text(target, text) {
  if (target.textContent !== text) target.textContent = text;
}

// A list in which arrow keys move the choice; `choose` gets the child that was clicked or moved to.
export function make_listbox(list, choose) {
  const is_row = list.getAttribute('aria-orientation') === 'horizontal';
  const [back, forth] = is_row ? ['ArrowLeft', 'ArrowRight'] : ['ArrowUp', 'ArrowDown'];
  list.addEventListener('click', (event) => {
    const option = event.target.closest('[role=option]');
    if (option) choose(option);
  });
  list.addEventListener('keydown', (event) => {
    const options = [...list.children].filter((option) => !option.hidden);
    const now = options.findIndex((option) => option.getAttribute('aria-selected') === 'true');
    const next = { [back]: now - 1, [forth]: now + 1, Home: 0, End: options.length - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const option = options[Math.max(0, Math.min(options.length - 1, next))];
    if (option) choose(option);
  });
}

export function select_option(list, chosen) {
  for (const option of list.children) {
    const is_chosen = option === chosen;
    if ((option.getAttribute('aria-selected') === 'true') !== is_chosen) {
      option.setAttribute('aria-selected', is_chosen);
    }
  }
  if (chosen) list.setAttribute('aria-activedescendant', chosen.id);
  else list.removeAttribute('aria-activedescendant');
}

// Scrolls within the list alone; scrollIntoView would move the whole page on a phone.
export function reveal(list, option) {
  const box = list.getBoundingClientRect();
  const own = option.getBoundingClientRect();
  if (own.top < box.top) list.scrollTop -= box.top - own.top;
  if (own.bottom > box.bottom) list.scrollTop += own.bottom - box.bottom;
  if (own.left < box.left) list.scrollLeft -= box.left - own.left + 12;
  if (own.right > box.right) list.scrollLeft += own.right - box.right + 12;
}

export const css_colour = (name) => {
  // Through an element, since custom properties keep light-dark() as it was written.
  const probe = element('span', { hidden: '' });
  probe.style.color = `var(${name})`;
  document.body.append(probe);
  const colour = getComputedStyle(probe).color;
  probe.remove();
  return colour;
};
