// Animation of a mode of a structure; three-dimensional drawings can be rotated. A measured mode also has a quadrature
// part, which leads by a quarter of a period.
const shapeView = (() => {
  const svg = (name, attributes) => {
    const node = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    return node;
  };
  const still = () => matchMedia('(prefers-reduced-motion: reduce)').matches;

  return ({ dimension, drawing }, element) => {
    const { points, lines, modes } = drawing;
    const solid = dimension === 3;
    const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k])));
    const high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
    const centre = low.map((l, k) => (l + high[k]) / 2);
    const size = Math.max(...high.map((h, k) => h - low[k])) || 1;
    const radius = Math.hypot(...high.map((h, k) => h - low[k])) / 2 || size / 2;
    const reach = 0.15 * size;
    let mode = 0, azimuth = 0.6, elevation = 0.35, phase = Math.PI / 2, playing = false, frame = 0;

    const flat = (p) => {
      const [x, y, z] = p.map((v, k) => v - centre[k]);
      if (!solid) return [x, -y];
      const across = x * Math.cos(azimuth) - y * Math.sin(azimuth);
      const away = x * Math.sin(azimuth) + y * Math.cos(azimuth);
      return [across, -(z * Math.cos(elevation) + away * Math.sin(elevation))];
    };
    const path = (moved) => lines.map((line) => line.map((i, k) => (k ? 'L' : 'M') + moved(i).map((v) => v.toPrecision(5)).join(' ')).join('')).join('');
    const wide = solid ? radius : (high[0] - low[0]) / 2, tall = solid ? radius : (high[1] - low[1]) / 2;
    const box = [-(wide + 1.3 * reach), -(tall + 1.3 * reach), 2 * (wide + 1.3 * reach), 2 * (tall + 1.3 * reach)];
    const unit = Math.max(box[2], box[3]) / 500;
    const rest = svg('path', { class: 'rest' }), moving = svg('path', { class: 'moving' });
    const picture = svg('svg', { viewBox: box.join(' '), role: 'img', class: 'shape' + (solid ? ' turns' : ''), ...(solid ? { tabindex: 0 } : {}) });
    picture.style.setProperty('--unit', `${unit}px`);
    picture.append(rest, moving);
    const show = () => {
      const { motions, quadrature } = modes[mode], amplitude = reach * Math.sin(phase), ahead = reach * Math.cos(phase);
      rest.setAttribute('d', path((i) => flat(points[i])));
      moving.setAttribute('d', path((i) => flat(points[i].map((v, k) => v + amplitude * motions[i][k] + (quadrature ? ahead * quadrature[i][k] : 0)))));
      picture.setAttribute('aria-label', `Mode ${mode + 1}, ${charts.number(modes[mode].frequency_hz, 4)} Hz, at rest and deformed`);
    };
    const step = (time) => {
      if (!playing) return;
      phase = (time / 1000) * Math.PI; // half a period per second, whatever the frequency
      show();
      frame = requestAnimationFrame(step);
    };
    const button = element('button', { type: 'button' }, 'Play');
    const play = (on) => {
      playing = on;
      button.textContent = on ? 'Pause' : 'Play';
      cancelAnimationFrame(frame);
      if (on) frame = requestAnimationFrame(step);
      else { phase = Math.PI / 2; show(); }
    };
    button.addEventListener('click', () => play(!playing));
    const choice = element('select', {}, ...modes.map((m, i) => element('option', { value: String(i) }, `Mode ${i + 1}: ${charts.number(m.frequency_hz, 5)} Hz`)));
    choice.addEventListener('change', () => { mode = Number(choice.value); show(); });
    if (solid) {
      const turn = (a, e) => {
        azimuth += a;
        elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, elevation + e));
        show();
      };
      picture.addEventListener('pointermove', (event) => { if (event.buttons === 1) turn(event.movementX / 150, event.movementY / 150); });
      picture.addEventListener('pointerdown', (event) => picture.setPointerCapture(event.pointerId));
      picture.addEventListener('keydown', (event) => {
        const by = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.15], ArrowDown: [0, 0.15] }[event.key];
        if (!by) return;
        event.preventDefault();
        turn(...by);
      });
    }
    addEventListener('beforeprint', () => play(false));
    show();
    return element('figure', { class: 'wide' }, element('p', { class: 'tools' }, element('label', {}, 'Shown: ', choice), button),
      picture, element('figcaption', {}, `At rest (thin) and deformed. The largest motion is drawn as ${charts.number(100 * reach / size, 2)} % of the structure's size, in slow motion, ${drawing.as ?? 'as computed for the intact structure'}.` + (solid ? ' Drag the drawing or use the arrow keys to rotate it.' : '')));
  };
})();

