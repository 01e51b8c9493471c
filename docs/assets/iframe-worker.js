// Lets the search run from the disk: a browser starts no worker from file://, so its script runs in a hidden frame.
if (location.protocol === "file:") {
  // The name by which the search script knows that it runs in a frame.
  self.IFrameWorker = class extends EventTarget {
    constructor(url) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.appendChild(frame);
      const inside = `
        postMessage = (data) => parent.dispatchEvent(new MessageEvent("message", {data, source: window}));
        importScripts = (...urls) => urls.reduce((before, url) => before.then(() => new Promise((done) => {
          const script = document.createElement("script");
          script.src = url;
          script.onload = done;
          document.body.appendChild(script);
        })), Promise.resolve());`;
      const page = frame.contentDocument;
      page.open();
      page.write(`<body><script>${inside}<\/script><script src="${url}"><\/script></body>`);
      page.close();
      this.frame = frame;
      this.ready = new Promise((done) => frame.contentWindow.addEventListener("load", done));
      self.addEventListener("message", (event) => {
        if (event.source === frame.contentWindow) this.dispatchEvent(new MessageEvent("message", {data: event.data}));
      });
    }

    postMessage(data) {
      this.ready.then(() => this.frame.contentWindow.dispatchEvent(new MessageEvent("message", {data})));
    }

    terminate() {
      this.frame.remove();
    }
  };
  self.Worker = self.IFrameWorker;
}
