// Canvases with the resolution of the screen, and the page's colours.
const COLOURS = {};

function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ['paper', 'panel', 'ink', 'muted', 'line', 'accent', 'wall', 'floor', 'unknown', 'lane', 'node',
                      'place', 'full', 'alarm', 'order', 'vivid', ...STATES.map((state) => state.name)]) {
    COLOURS[name] = style.getPropertyValue(`--${name}`).trim();
  }
}

// Let a canvas cover its element; return its context, in CSS pixels, or null if the element has no size. For print an
// SVG picture takes the place of the canvas.
function prepare(canvas, width, height) {
  if (document.documentElement.classList.contains('print')) {
    if (!width || !height) return null;
    if (!canvas.picture) {
      canvas.after(canvas.picture = document.createElementNS(SVG, 'svg'));
      canvas.picture.classList.add('drawn');
    }
    return new VectorContext(canvas.picture, width, height);
  }
  const ratio = window.devicePixelRatio || 1;
  const [columns, rows] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (!columns || !rows) return null;
  if (canvas.width !== columns || canvas.height !== rows) Object.assign(canvas, {width: columns, height: rows});
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return context;
}

// Make [[x, y], ...] [px] the path of a context, closed or open.
function trace(context, points, isClosed = true) {
  context.beginPath();
  points.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
  if (isClosed) context.closePath();
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

// Save the map of the first run as an SVG picture, dark on white, with the present view.
function savePicture(player) {
  const [view] = player.maps, {clientWidth: width, clientHeight: height} = view.figure;
  const svg = document.createElementNS(SVG, 'svg'), isPrint = document.documentElement.classList.contains('print');
  document.documentElement.classList.add('print');
  readColours();
  if (player.ground) player.ground.paint();
  view.drawOn(new VectorContext(svg, width, height), width, height);
  document.documentElement.classList.toggle('print', isPrint);
  player.recolour();
  const link = Object.assign(document.createElement('a'), {
    download: `replay_${(player.time / NS_PER_S).toFixed(3)}s.svg`,
    href: URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(svg)], {type: 'image/svg+xml'}))});
  link.click();
  URL.revokeObjectURL(link.href);
}
