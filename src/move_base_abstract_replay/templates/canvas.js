// A canvas that is as sharp as the screen, and the page's colours.
const COLOURS = {};

function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ['paper', 'panel', 'ink', 'muted', 'line', 'accent', 'wall', 'floor', 'unknown',
                      'failed', 'charging', 'moving', 'task', 'waiting', 'idle']) {
    COLOURS[name] = style.getPropertyValue(`--${name}`).trim();
  }
}

// Have a canvas cover its element; return its context, in CSS pixels, or null where there is nothing to draw on.
function prepare(canvas, width, height) {
  const ratio = window.devicePixelRatio || 1;
  const [columns, rows] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (!columns || !rows) return null;
  if (canvas.width !== columns || canvas.height !== rows) Object.assign(canvas, {width: columns, height: rows});
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return context;
}

function cut(context, text, width) {
  if (context.measureText(text).width <= width) return text;
  let length = text.length;
  while (length > 1 && context.measureText(`${text.slice(0, length)}…`).width > width) length -= 1;
  return `${text.slice(0, length)}…`;
}

function rgb(colour) {
  const number = parseInt(colour.slice(1), 16);
  return [number >> 16, (number >> 8) & 255, number & 255];
}
