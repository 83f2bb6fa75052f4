// Numbers and events as texts for people.
const THIN = '\u202f';

function grouped(text) {
  const [whole, rest] = text.split('.');
  const parts = whole.replace(/\B(?=(\d{3})+(?!\d))/g, THIN);
  return rest === undefined ? parts : `${parts}.${rest}`;
}

// A time [ns] as text in s, to the millisecond.
function seconds(time) {
  return grouped((time / NS_PER_S).toFixed(3));
}

function withMinus(text) {
  return text.replace('-', '\u2212');
}

function metres(value) {
  return withMinus((Math.round(value * 100) === 0 ? 0 : value).toFixed(2));
}

function degrees(yaw) {
  return withMinus(`${Math.round(yaw * 180 / Math.PI) || 0}°`);
}

function place(x, y, yaw) {
  return `(${metres(x)}, ${metres(y)}) m, ${degrees(yaw)}`;
}

function messageText(kind, values) {
  const bytes = values[values.length - 2];
  const receivers = values.slice(1, values.length - 2 - (kind === 'response' ? 1 : 0));
  return `${kind === 'message' ? '' : `${kind} `}${values[0] || 'nobody'} → ${receivers.join(', ') || 'nobody'}, ${grouped(String(bytes))} bytes`;
}

const EVENT_TEXTS = {
  goal: (v) => `gets the goal ${v[0]}`,
  departed: (v) => `departs for ${place(...v)}`,
  driven: (v) => `drives with ${metres(v[3])} m/s${v[4] ? `, ${metres(v[4])} m/s to the left` : ''}, turns with ${metres(v[5])} rad/s`,
  stalled: (v) => `stalls at ${v[0]}`,
  pieces: (v) => `drives in ${v[0]} pieces`,
  stands: (v) => `stands at ${place(...v)}`,
  ended: (v) => `goal ${v[1]}${v[2] ? ` · ${v[2]}` : ''} · ${v[0]}`,
  motion: (v) => `is at ${place(v[0], v[1], v[2])}; at most ${v[3]} m/s`,
  task_began: (v) => `task begins, ${seconds(v[1])} s · ${v[0]}`,
  task_ended: (v) => `task ${v[1]} · ${v[0]}`,
  message: (v) => messageText('message', v),
  call: (v) => messageText('call', v),
  response: (v) => messageText('response', v),
};

// An event as text. Any program may write a row of any kind; a row of another form is shown as it is.
function eventText(run, index) {
  const kind = run.kinds[run.event_kind[index]];
  const values = JSON.parse(run.event_values[index]);
  if (Object.hasOwn(EVENT_TEXTS, kind)) {
    try {
      const text = EVENT_TEXTS[kind](values);
      if (!/undefined|NaN/.test(text)) return text;
    } catch (error) { /* shown as it is */ }
  }
  return `${kind} ${values.map((value) => (typeof value === 'string' ? value : JSON.stringify(value))).join(', ')}`;
}

// The smallest step of 1, 2 or 5 times a power of ten that is at least `least`.
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= least * 0.999999);
}
