// The camera's picture with what was recognised in it.
function css({ r, g, b, a }) {
  return `rgba(${r * 255}, ${g * 255}, ${b * 255}, ${a})`;
}

export class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.image = new Image();
    this.annotations = { points: [], texts: [] };
    this.stale = false;
    this.shown = 0;
  }

  show({ format, data }) {
    const kind = format === "png" ? "png" : "jpeg";
    const image = new Image();
    image.onload = () => {
      this.image = image;
      this.stale = true;
      this.canvas.dataset.pictures = String(++this.shown);
    };
    image.src = `data:image/${kind};base64,${data}`;
  }

  annotate(annotations) {
    this.annotations = annotations;
    this.stale = true;
  }

  draw() {
    if (!this.stale) return;
    this.stale = false;
    const { canvas, context, image } = this;
    if (image.naturalWidth && canvas.width !== image.naturalWidth) canvas.width = image.naturalWidth;
    if (image.naturalHeight && canvas.height !== image.naturalHeight) canvas.height = image.naturalHeight;
    context.clearRect(0, 0, canvas.width, canvas.height);
    if (image.naturalWidth) context.drawImage(image, 0, 0);
    for (const { points, outline_color, thickness } of this.annotations.points) {
      context.beginPath();
      points.forEach((p, i) => (i ? context.lineTo(p.x, p.y) : context.moveTo(p.x, p.y)));
      context.closePath();
      context.strokeStyle = css(outline_color);
      context.lineWidth = thickness;
      context.stroke();
    }
    for (const { position, text, font_size, text_color, background_color } of this.annotations.texts) {
      context.font = `${font_size}px sans-serif`;
      const width = context.measureText(text).width + 6;
      const left = Math.max(0, Math.min(position.x, canvas.width - width));
      context.fillStyle = css(background_color);
      context.fillRect(left, position.y - font_size, width, font_size + 4);
      context.fillStyle = css(text_color);
      context.fillText(text, left + 3, position.y);
    }
  }
}
