// A drawing context, like that of a canvas, that makes an SVG picture: the drawings of the page become lines and text
// for print. It has only those parts of a context that this page uses.
const SVG = document.querySelector('svg').namespaceURI;
const short = (value) => +value.toFixed(2);

class VectorContext {
  constructor(svg, width, height) {
    Object.assign(this, {svg, fillStyle: '#000', strokeStyle: '#000', lineWidth: 1, globalAlpha: 1, lineJoin: 'miter',
                         lineCap: 'butt', textBaseline: 'alphabetic', textAlign: 'left', font: '12px sans-serif',
                         path: '', dashes: [], matrix: [1, 0, 0, 1, 0, 0], saved: []});
    this.ruler = document.createElement('canvas').getContext('2d');
    svg.replaceChildren();
    for (const [name, value] of Object.entries({viewBox: `0 0 ${width} ${height}`, width, height})) {
      svg.setAttribute(name, value);
    }
  }

  save() { this.saved.push([this.matrix, this.globalAlpha]); }
  restore() { [this.matrix, this.globalAlpha] = this.saved.pop(); }
  clearRect() {}
  setLineDash(dashes) { this.dashes = dashes; }

  translate(x, y) {
    const [a, b, c, d, e, f] = this.matrix;
    this.matrix = [a, b, c, d, e + a * x + c * y, f + b * x + d * y];
  }

  rotate(angle) {
    const [a, b, c, d, e, f] = this.matrix, [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    this.matrix = [a * cos + c * sin, b * cos + d * sin, c * cos - a * sin, d * cos - b * sin, e, f];
  }

  point(x, y) {
    const [a, b, c, d, e, f] = this.matrix;
    return `${short(a * x + c * y + e)} ${short(b * x + d * y + f)}`;
  }

  beginPath() { this.path = ''; }
  moveTo(x, y) { this.path += `M${this.point(x, y)}`; }
  lineTo(x, y) { this.path += `${this.path ? 'L' : 'M'}${this.point(x, y)}`; }
  closePath() { this.path += 'Z'; }

  arc(x, y, radius, from, to) {
    const at = (angle) => this.point(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
    const middle = (from + to) / 2, large = Math.abs(to - from) / 2 > Math.PI ? 1 : 0;
    const piece = (end) => `A${short(radius)} ${short(radius)} 0 ${large} ${to > from ? 1 : 0} ${at(end)}`;
    this.path += `${this.path && !this.path.endsWith('Z') ? 'L' : 'M'}${at(from)}${piece(middle)}${piece(to)}`;
  }

  add(name, attributes, text) {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    if (this.globalAlpha < 1) element.setAttribute('opacity', short(this.globalAlpha));
    this.svg.appendChild(element);
  }

  get pen() {
    return {fill: 'none', stroke: this.strokeStyle, 'stroke-width': short(this.lineWidth),
            'stroke-linejoin': this.lineJoin, 'stroke-linecap': this.lineCap,
            ...(this.dashes.length ? {'stroke-dasharray': this.dashes.join(' ')} : {})};
  }

  stroke() { if (this.path) this.add('path', {d: this.path, ...this.pen}); }
  fill() { if (this.path) this.add('path', {d: this.path, fill: this.fillStyle}); }

  corners(x, y, width, height) {
    return `M${this.point(x, y)}L${this.point(x + width, y)}L${this.point(x + width, y + height)}L${this.point(x, y + height)}Z`;
  }

  fillRect(...box) { this.add('path', {d: this.corners(...box), fill: this.fillStyle}); }
  strokeRect(...box) { this.add('path', {d: this.corners(...box), ...this.pen}); }

  measureText(text) {
    this.ruler.font = this.font;
    return this.ruler.measureText(text);
  }

  write(text, x, y, look) {
    const [, weight, size] = /^(\d+ )?(\d+)px/.exec(this.font), [px, py] = this.point(x, y).split(' ');
    const down = this.textBaseline === 'middle' ? 0.35 * size : 0;
    this.add('text', {x: px, y: short(+py + down), 'font-size': size, 'font-family': 'Helvetica, Arial, sans-serif',
                      ...(weight ? {'font-weight': weight.trim()} : {}),
                      ...(this.textAlign === 'center' ? {'text-anchor': 'middle'} : {}), ...look}, text);
  }

  fillText(text, x, y) { this.write(text, x, y, {fill: this.fillStyle}); }
  strokeText(text, x, y) { this.write(text, x, y, this.pen); }

  drawImage(picture, x, y, width, height) {
    this.add('image', {href: picture.toDataURL(), x, y, width, height, preserveAspectRatio: 'none',
                       transform: `matrix(${this.matrix.map((value) => +value.toFixed(6)).join(' ')})`,
                       style: 'image-rendering: pixelated'});
  }
}
