"""Pages in a real browser: Chromium without a screen, driven by Selenium. Without them the tests are skipped."""
import inspect
import os
import shutil
import sys

import pytest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..', '..', 'src'))
sys.path.insert(0, os.path.join(HERE, '..', 'unit'))

GUARD = 60.0  # s, wall; only ends a test that would never end
_FLAGS = ('--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--hide-scrollbars',
          '--force-device-scale-factor=1', '--disable-background-networking', '--window-size=1280,800')


class Browser:
    """A browser with one page and its console."""

    def __init__(self, driver):
        self.driver = driver

    def open(self, path, width=1280, height=800, dark=False, ready="document.body.classList.contains('ready')"):
        """Open a file, and wait until the expression ``ready`` is true in the page."""
        self.driver.get('about:blank')
        self.console()
        self.driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
            'width': width, 'height': height, 'deviceScaleFactor': 1, 'mobile': width < 600})
        self.driver.execute_cdp_cmd('Emulation.setEmulatedMedia', {'features': [
            {'name': 'prefers-color-scheme', 'value': 'dark' if dark else 'light'}]})
        self.driver.get('file://{}'.format(path))
        self.wait('return ' + ready)

    def run(self, script, *arguments):
        """Run a script in the page, and return its result."""
        return self.driver.execute_script(script, *arguments)

    def wait(self, script):
        """Wait until a script in the page returns something true, and return that."""
        from selenium.webdriver.support.ui import WebDriverWait
        return WebDriverWait(self.driver, GUARD, 0.02).until(lambda driver: driver.execute_script(script))

    def frame(self):
        """Wait until the page has drawn its present state."""
        self.driver.execute_async_script(
            'const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()))')

    def click(self, css):
        """Click on an element."""
        self.driver.find_element('css selector', css).click()

    def press(self, *keys):
        """Press keys in the element that has the focus."""
        from selenium.webdriver.common.action_chains import ActionChains
        ActionChains(self.driver).send_keys(*keys).perform()

    def console(self):
        """Return the messages of the console since the last call."""
        return [entry['message'] for entry in self.driver.get_log('browser')]


@pytest.fixture(scope='session')
def _driver():
    program, driver = shutil.which('chromium') or shutil.which('chromium-browser'), shutil.which('chromedriver')
    if not program or not driver:
        pytest.skip('no Chromium, or no chromedriver: install chromium and chromium-driver')
    webdriver = pytest.importorskip('selenium.webdriver', reason='no Selenium: install python3-selenium')
    from selenium.webdriver.chrome.service import Service
    options = webdriver.ChromeOptions()
    options.binary_location = program
    for flag in _FLAGS:
        options.add_argument(flag)
    options.set_capability('goog:loggingPrefs', {'browser': 'ALL'})
    how = ({'service': Service(driver)} if 'service' in inspect.signature(webdriver.Chrome.__init__).parameters
           else {'executable_path': driver})  # Debian 11
    opened = webdriver.Chrome(options=options, **how)
    opened.set_script_timeout(GUARD)
    yield opened
    opened.quit()


@pytest.fixture
def browser(_driver):
    """Yield the Browser; at the end of the test its console must be empty."""
    browser = Browser(_driver)
    yield browser
    assert browser.console() == []
